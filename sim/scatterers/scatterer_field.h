// Scatterers fixed in the tissue. Each is a hash of its cell of tissue at rest: the same from
// wherever it is seen, moving with the tissue, never stored.
//
// A stick looks at the hash cells that its beam passes and leaves out those that lie in fluid,
// beyond the beam's rim, or where nothing is left of the sound. What remains echoes with the beam's
// response at its place (sim/beam/beam_table.h), the phase of its way, and an amplitude such that
// tissue all around has the mean echo power of its material at every range:
//   amplitude^2 = power / (density * integral of |point spread|^2).
#pragma once

#include <complex>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"
#include "sim/scatterers/scatterer_scene.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

/// What a stick knows of its way before scatterers are asked for. One value an IQ sample; sample i
/// lies at apparent range (i + 1/2) * spacing_m.
struct StickPath {
  Sightline line;
  double spacing_m = 0;  ///< of the plan's IQ samples (sim/echo/iq_field.h)
  /// Two-way amplitude left at the sample, on the axis; samples from left.size() on are lost.
  std::span<const float> left;
  /// Apparent less true range at the sample; empty: none (one sound speed everywhere).
  std::span<const float> delay_m;
};

/// One scatterer as it is now.
struct PointEcho {
  glm::dvec3 position_m{0};  ///< probe frame
  float amplitude = 0;       ///< of its echo, were it on the axis at its range
};

/// Const functions may be called from several threads.
class ScattererField {
 public:
  ScattererField(const ScannedTissue& subject,
                 const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options)
      : ScattererField(subject, plan, options, ScattererModel::of(options)) {}
  ScattererField(const ScannedTissue& subject,
                 const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options,
                 const ScattererModel& model);

  /// Adds the echoes of all scatterers that the stick's beam reaches. `iq` is one stick at the IQ
  /// rate. `seen`, if given, is increased by the number of scatterers that contributed.
  void add_echoes(const StickPath& way,
                  std::span<std::complex<float>> iq,
                  std::uint64_t* seen = nullptr) const;

  /// The same for given scatterers in place of the tissue's.
  void add_points(const StickPath& way,
                  std::span<const PointEcho> points,
                  std::span<std::complex<float>> iq) const;

  /// The scatterers that add_echoes() uses for a stick on which nothing is lost, up to a true
  /// range.
  std::vector<PointEcho> near(const Sightline& line, double to_m) const;

  double per_cubic_mm() const { return scene_->per_m3 * 1e-9; }
  /// Integral of |point spread|^2 at a range, for a response of 1 on the axis.
  double point_spread_m3(double range_m) const;
  const BeamTable& beam() const { return scene_->table; }

 private:
  std::shared_ptr<const ScattererScene> scene_;
};

}  // namespace wobblebench::sim
