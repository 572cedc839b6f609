// The rung `reference`: the tissue's scatterers, each summed over the elements of the probe. The
// yardstick of the other rungs, for small scenes.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"
#include "sim/scatterers/scatterer_field.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

/// Const functions may be called from several threads.
class ReferenceScene {
 public:
  /// Throws InvalidOption "fidelity = reference: ..." before any echo is made if all sticks of
  /// a volume would take too long.
  ReferenceScene(const ScannedTissue& subject,
                 const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options);

  /// Adds the echoes of the scatterers that the rung `scatterers` would use with side lobes, each
  /// with the amplitude that it has there: a lone scatterer on the axis echoes as strongly in both.
  void add_echoes(const StickPath& way, std::span<std::complex<float>> iq) const;
  /// The same for given scatterers in place of the tissue's.
  void add_points(const StickPath& way,
                  std::span<const PointEcho> points,
                  std::span<std::complex<float>> iq) const;

 private:
  void check_cost() const;
  double on_axis(double range_m) const;

  hw::AcquisitionPlan plan_;
  ScattererField field_;
  double axis_step_m_;
  std::vector<double> on_axis_;  ///< echo of a scatterer on the axis, in the middle of the sector
};

}  // namespace wobblebench::sim
