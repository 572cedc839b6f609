// The true surfaces that a scan can show: without those in the shadow of what is in front of them.
#pragma once

#include <vector>

#include "bench/evaluation/truth/truth.h"
#include "bench/scene/resolved_scene.h"
#include "hw/probe/motor_deviation.h"
#include "render/camera.h"
#include "sim/options.h"
#include "sim/probe_simulator.h"

namespace wobblebench::bench {

/// Mean echo of the brightest tissue on either side of the target surfaces, as
/// phantoms::Material::backscatter_db.
double brightest_target_db(const phantoms::Phantom& phantom);

/// Penetration of each stick of a volume: the greatest true range at which the mean echo of the
/// phantom's brightest target tissue, after two-way losses (sim/losses), is above the RMS noise and
/// within the dynamic range of the display.
class StickReach {
 public:
  /// Traces every stick. The rung geometry has no losses: sticks reach their ends. `maps` is asked
  /// for the map that sim::ProbeSimulator asks for. Throws InvalidOption.
  StickReach(const phantoms::PlacedPhantom& subject,
             const hw::AcquisitionPlan& plan,
             const sim::SimulationOptions& options,
             const sim::TissueMapSource& maps = {},
             std::uint32_t volume = 0);
  explicit StickReach(const ResolvedScene& scene,
                      const sim::TissueMapSource& maps = {},
                      std::uint32_t volume = 0)
      : StickReach(scene.subject().value(), scene.plan(), scene.simulation(), maps, volume) {}

  /// m, of the stick nearest to a position.
  double at(const glm::dvec3& position_m) const;

 private:
  void trace(const phantoms::PlacedPhantom& subject,
             const sim::SimulationOptions& options,
             const sim::TissueMapSource& maps,
             double reach_m);

  hw::AcquisitionPlan plan_;
  hw::ProbeGeometry geometry_;
  std::uint32_t volume_;
  std::vector<double> reach_m_;  ///< [frame * lines + line]
};

/// Surfaces beyond their stick's reach become `shadowed`. The truth must know its crossings.
void mark_shadowed(Truth& truth, const StickReach& reach, const render::Camera& camera);

/// Surfaces beyond the motor angles of the sticks become `outside_field`.
void mark_outside(Truth& truth,
                  const hw::MotorDeviation& motor,
                  const hw::ProbeGeometry& geometry,
                  const render::Camera& camera);

/// What a picture of this volume is compared with: trace_truth(), then mark_shadowed(). The scene's
/// subject must be known. Throws InvalidOption.
Truth true_surface(const ResolvedScene& scene,
                   const sim::TissueMapSource& maps = {},
                   std::uint32_t volume = 0);
/// The same for another view, with the reach of the volume's sticks.
Truth true_surface(const ResolvedScene& scene,
                   const render::View& view,
                   const StickReach& reach,
                   std::uint32_t volume = 0);

}  // namespace wobblebench::bench
