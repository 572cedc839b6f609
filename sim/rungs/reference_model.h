// The rung `reference`: the scatterers of the tissue, each summed over the elements of the probe.
#pragma once

#include "sim/rungs/iq_model.h"
#include "sim/rungs/reference_scene.h"
#include "sim/rungs/stick_propagation.h"

namespace wobblebench::sim {

/// For small scenes: the constructor throws InvalidOption for larger ones.
class ReferenceModel final : public IqModel {
 public:
  static const EchoModelType kType;

  ReferenceModel(const ScannedTissue& tissue,
                 const hw::AcquisitionPlan& plan,
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
