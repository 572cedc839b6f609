// The rung `scatterers`: point scatterers fixed in the tissue, so that speckle moves with it.
#pragma once

#include "sim/rungs/echo_model.h"
#include "sim/rungs/stick_propagation.h"
#include "sim/speckle/scatterers/scatterer_field.h"

namespace wobblebench::sim {

class ScatterersModel final : public IqModel {
 public:
  static const EchoModelType kType;

  ScatterersModel(const ScannedTissue& tissue,
                  const ProbeOptics& optics,
                  const SimulationOptions& options);

  const EchoModelType& type() const override { return kType; }
  void prepare(std::uint32_t volume) const override { propagation_.prepare(volume); }
  IqMaker iq_maker() const override;

  /// Upper bound of half the diagonal of a hash cell plus the thickness of the layer of scatterers
  /// that represents a rough interface.
  static double reach_m(const hw::AcquisitionPlan& plan);

 private:
  ScannedTissue tissue_;
  StickPropagation propagation_;  ///< copied into each IQ maker
  ScattererField scatterers_;
  PointsInBeam points_;  ///< copied into each IQ maker
};

}  // namespace wobblebench::sim
