// Which true surfaces lie in the shadow of what is in front of them.
#pragma once

#include <vector>

#include "bench/evaluation/truth/truth.h"
#include "render/camera.h"
#include "sim/options.h"
#include "sim/probe_simulator.h"

namespace wobblebench::bench {

/// Of the tissues on either side of the target surfaces, the mean echo of the brightest one, as
/// phantoms::Material::backscatter_db.
double brightest_target_db(const phantoms::Phantom& phantom);

/// How far each stick of a volume hears tissue: the last true range at which an echo as strong as
/// the mean one of the phantom's brightest target tissue, after all losses of its way there and
/// back (sim/losses), is neither below the RMS noise nor below the display's dynamic
/// range.
class StickReach {
 public:
  /// Traces every stick. The rung geometry has no losses: sticks reach their ends. `maps` is asked
  /// for the map that sim::ProbeSimulator asks for. Throws InvalidOption.
  StickReach(const phantoms::PlacedPhantom& subject,
             const hw::AcquisitionPlan& plan,
             const sim::SimulationOptions& options,
             const sim::TissueMapSource& maps = {},
             std::uint32_t volume = 0);

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

}  // namespace wobblebench::bench
