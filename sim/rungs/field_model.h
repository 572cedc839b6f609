// The rung `field`: homogeneous speckle, scaled by the mean echo power of the tissue.
#pragma once

#include <optional>

#include "sim/rungs/echo_model.h"
#include "sim/rungs/mean_power.h"
#include "sim/rungs/stick_propagation.h"
#include "sim/speckle/iq_field.h"
#include "sim/speckle/scatterers/scatterer_field.h"

namespace wobblebench::sim {

/// Speckle is fixed to the sticks, so it does not move with the tissue.
class FieldModel final : public IqModel {
 public:
  static const EchoModelType kType;

  FieldModel(const ScannedTissue& tissue,
             const ProbeOptics& optics,
             const SimulationOptions& options);

  const EchoModelType& type() const override { return kType; }
  void prepare(std::uint32_t volume) const override { propagation_.prepare(volume); }
  IqMaker iq_maker() const override;

 private:
  ScannedTissue tissue_;
  StickPropagation propagation_;  ///< copied into each IQ maker, like mean_power_
  MeanPower mean_power_;
  bool has_speckle_;
  IqField speckle_;  ///< of unit power; empty without speckle
  // Set only if the phantom has point scatterers.
  std::optional<ScattererField> echoing_;
  std::optional<PointsInBeam> points_;  ///< copied into each IQ maker
};

}  // namespace wobblebench::sim
