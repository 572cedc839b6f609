// Echoes of the tissue's scatterers by summation over the elements of the probe: the reference of
// the other rungs, for small scenes.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"
#include "sim/speckle/scatterers/points_in_beam.h"
#include "sim/speckle/scatterers/scatterer_field.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

/// Const functions may be called from several threads.
class ReferenceScene {
 public:
  /// Throws InvalidOption "fidelity = reference: ..." if computing a volume would take more than
  /// half an hour of one core.
  ReferenceScene(const ScannedTissue& tissue,
                 const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options);

  /// Adds the echoes of the scatterers that the rung `scatterers` uses with side lobes, with the
  /// same amplitudes: the echo of one scatterer on the axis is equally strong in both.
  void add_echoes(const StickPath& path, std::span<std::complex<float>> iq) const;
  /// The same for given scatterers instead of the tissue's.
  void add_points(const StickPath& path,
                  std::span<const PointEcho> points,
                  std::span<std::complex<float>> iq) const;

  /// The phantom's point scatterers; add_echoes() leaves them out.
  const PointsInBeam& points() const { return points_; }

 private:
  void check_cost() const;
  double on_axis(double range_m) const;

  hw::AcquisitionPlan plan_;
  Apodisation apodisation_;
  ScattererField scatterers_;
  PointsInBeam points_;
  double axis_step_m_;
  /// Echo of a scatterer on the axis of the middle stick, at ranges (i + 1/2) * axis_step_m_.
  std::vector<double> on_axis_;
};

}  // namespace wobblebench::sim
