// The rung `geometry`: the mean echo of the tissue at each sample.
#pragma once

#include <vector>

#include "sim/rungs/echo_model.h"
#include "sim/tissue/stick_track.h"

namespace wobblebench::sim {

/// No speckle, beam, losses or noise: each sample has the mean backscatter of the material on the
/// axis at its range, log-compressed if the options ask for it.
class GeometryModel final : public EchoModel {
 public:
  static const EchoModelType kType;

  GeometryModel(const ScannedTissue& tissue,
                const hw::AcquisitionPlan& plan,
                const SimulationOptions& options);

  const EchoModelType& type() const override { return kType; }
  StickMaker stick_maker(const IqSink& iq) const override;

 private:
  void fill(const StickTrack& track, std::span<float> samples) const;

  ScannedTissue tissue_;
  hw::AcquisitionPlan plan_;
  std::vector<float> sample_of_material_;
};

}  // namespace wobblebench::sim
