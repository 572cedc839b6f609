// The rung `reference`: the scatterers of the tissue, each summed over the elements of the probe.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"
#include "sim/rungs/echo_model.h"
#include "sim/rungs/stick_propagation.h"
#include "sim/speckle/scatterers/scatterer_field.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

/// Const functions may be called from several threads.
class ReferenceScene {
 public:
  /// Throws InvalidOption "fidelity = reference: ..." if computing a volume would take more than
  /// half an hour of one core.
  ReferenceScene(const ScannedTissue& tissue,
                 const ProbeOptics& optics,
                 const SimulationOptions& options);

  /// Adds the echoes of the scatterers that the rung `scatterers` uses with side lobes, with the
  /// same amplitudes: the echo of a scatterer on the axis is equally strong on both rungs.
  void add_echoes(const StickPath& path, std::span<std::complex<float>> iq) const;
  /// Adds the echoes of given scatterers instead of those of the tissue.
  void add_points(const StickPath& path,
                  std::span<const PointEcho> points,
                  std::span<std::complex<float>> iq) const;

  /// The phantom's point scatterers; add_echoes() leaves them out.
  const PointsInBeam& points() const { return points_; }

 private:
  void check_cost() const;
  double on_axis(double range_m) const;

  ProbeOptics optics_;
  ScattererField scatterers_;
  PointsInBeam points_;
  double axis_step_m_;
  /// Echo of a scatterer on the axis of the middle stick, at ranges (i + 1/2) * axis_step_m_.
  std::vector<double> on_axis_;
};

/// For small scenes: the constructor throws InvalidOption for larger ones.
class ReferenceModel final : public IqModel {
 public:
  static const EchoModelType kType;

  ReferenceModel(const ScannedTissue& tissue,
                 const ProbeOptics& optics,
                 const SimulationOptions& options);

  const EchoModelType& type() const override { return kType; }
  void prepare(std::uint32_t volume) const override { propagation_.prepare(volume); }
  IqMaker iq_maker() const override;

 private:
  ScannedTissue tissue_;
  StickPropagation propagation_;  ///< copied into each IQ maker
  ReferenceScene scene_;
};

}  // namespace wobblebench::sim
