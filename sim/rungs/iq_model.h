// The base of models that compute noiseless IQ echoes and leave detection to a Receiver.
#pragma once

#include <complex>
#include <functional>
#include <memory>
#include <span>

#include "sim/receive/receiver.h"
#include "sim/rungs/echo_model.h"

namespace wobblebench::sim {

/// Computes the noiseless IQ samples of one stick; they are valid until the next call. Holds the
/// working memory of one thread.
using IqMaker = std::function<std::span<const std::complex<float>>(const hw::StickIndex& index)>;

class IqModel : public EchoModel {
 public:
  IqModel(const hw::AcquisitionPlan& plan, const SimulationOptions& options);

  /// IQ samples and then the receive chain, with noise of the stick's own.
  StickMaker stick_maker(const IqSink& sink) const final;
  virtual IqMaker iq_maker() const = 0;

 private:
  hw::AcquisitionPlan plan_;
  std::uint64_t seed_;
  Receiver receiver_;  ///< copied into each stick maker
};

/// Where neither tissue nor sticks change from volume to volume, computes the echoes of one volume,
/// to be used for all, and deletes `model`; elsewhere returns `model`.
std::unique_ptr<const EchoModel> reuse_echoes(std::unique_ptr<const IqModel> model,
                                              const ScannedTissue& tissue,
                                              const hw::AcquisitionPlan& plan,
                                              const SimulationOptions& options);

/// EchoModelType::memory of an IqModel that itself stores `model_bytes`.
EchoMemory iq_memory(const hw::AcquisitionPlan& plan,
                     const SimulationOptions& options,
                     bool tissue_moves,
                     double model_bytes);

/// EchoModelType::make of an IqModel.
template <class Model>
std::unique_ptr<const EchoModel> make_iq_model(const ScannedTissue& tissue,
                                               const hw::AcquisitionPlan& plan,
                                               const SimulationOptions& options) {
  return reuse_echoes(std::make_unique<Model>(tissue, plan, options), tissue, plan, options);
}

}  // namespace wobblebench::sim
