// The interface between a scan and the rungs of the ladder of fidelity: EchoModel, its factory, and
// IqModel, the base of the rungs that compute IQ echoes.
#pragma once

#include <complex>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>

#include "hw/probe/acquisition_plan.h"
#include "sim/echo_store.h"
#include "sim/iq_sink.h"
#include "sim/optics/probe_optics.h"
#include "sim/options.h"
#include "sim/receive/receiver.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

struct EchoModelType;

/// Computes the detected samples of one stick, given its sequence number, into `samples`, on the
/// scale that the options name. Holds the working memory of one thread.
using StickMaker = std::function<void(std::uint64_t sequence, std::span<float> samples)>;

/// One rung: how tissue becomes sticks. Immutable; const functions may be called from several
/// threads, and each thread takes a stick maker of its own. The model must outlive its makers.
class EchoModel {
 public:
  EchoModel() = default;
  virtual ~EchoModel() = default;
  EchoModel(const EchoModel&) = delete;
  EchoModel& operator=(const EchoModel&) = delete;

  virtual const EchoModelType& type() const = 0;
  /// Computes the data that the sticks of a volume share, on the threads of the options. Without
  /// this call the first stick computes them while other threads wait.
  virtual void prepare(std::uint32_t /*volume*/) const {}
  /// If given, `iq` is called with the IQ samples of each stick. Throws std::logic_error if it is
  /// given to a rung that makes none.
  virtual StickMaker stick_maker(const IqSink& iq) const = 0;
};

/// Number of frames whose sticks are computed together.
inline constexpr int kFramesTogether = 16;

/// Stick number `i` of a volume in the order of computation, on which results do not depend:
/// kFramesTogether at a time, line by line. The sticks of a line share the beam's tables of their
/// angle, and neighbouring frames the tissue, so that both stay in the cache.
hw::StickIndex stick_in_order(const hw::AcquisitionPlan& plan, std::uint32_t volume, int i);

/// Bytes of a model's largest arrays.
struct EchoMemory {
  double constructing = 0;  ///< peak in the constructor
  double kept = 0;
};

/// True if neither the tissue nor the directions of the sticks change from volume to volume.
bool volumes_repeat(const hw::AcquisitionPlan& plan, bool tissue_moves);

/// The properties of a rung, before a model is made.
struct EchoModelType {
  std::string_view name;
  /// The next lower rung, whose effects this one models too; null: this is the lowest.
  const EchoModelType* lower;
  /// The effects that this rung adds, by their names in reports.
  std::span<const std::string_view> added_effects;
  /// Distance from a stick up to which surfaces contribute; a TissueMap has to cover it.
  double (*reach_m)(const hw::AcquisitionPlan& plan);
  EchoMemory (*memory)(const hw::AcquisitionPlan& plan,
                       const SimulationOptions& options,
                       bool tissue_moves);
  std::unique_ptr<const EchoModel> (*make)(const ScannedTissue& tissue,
                                           const hw::AcquisitionPlan& plan,
                                           const SimulationOptions& options,
                                           const EchoStore& store);

  /// True if the rung models an effect, by its name in sim/fidelity.h.
  bool models(std::string_view effect) const;
  /// True if the echoes are IQ samples, which a Receiver detects.
  bool makes_iq() const { return models("envelope"); }
};

/// Throws std::logic_error for `automatic`, which choose_fidelity() resolves.
const EchoModelType& echo_model_type(Rung rung);

/// Throws InvalidOption if the scene is too large for the rung.
std::unique_ptr<const EchoModel> make_echo_model(Rung rung,
                                                 const ScannedTissue& tissue,
                                                 const hw::AcquisitionPlan& plan,
                                                 const SimulationOptions& options,
                                                 const EchoStore& store = {});

/// Computes the noiseless IQ samples of one stick; they are valid until the next call. Holds the
/// working memory of one thread.
using IqMaker = std::function<std::span<const std::complex<float>>(const hw::StickIndex& index)>;

class IqModel : public EchoModel {
 public:
  IqModel(const hw::AcquisitionPlan& plan, const SimulationOptions& options);

  /// Computes the IQ samples and then applies the receive chain, with noise that depends on the
  /// stick.
  StickMaker stick_maker(const IqSink& sink) const final;
  virtual IqMaker iq_maker() const = 0;

 private:
  hw::AcquisitionPlan plan_;
  std::uint64_t seed_;
  Receiver receiver_;  ///< copied into each stick maker
};

using MakeIqModel = std::function<std::unique_ptr<const IqModel>()>;

/// If neither tissue nor sticks change from volume to volume, returns a model that uses the echoes
/// of one volume for all: those of `store`, or, kept there, of the model that `make` returns.
/// Otherwise returns that model.
std::unique_ptr<const EchoModel> reuse_echoes(const MakeIqModel& make,
                                              const EchoModelType& type,
                                              const ScannedTissue& tissue,
                                              const hw::AcquisitionPlan& plan,
                                              const SimulationOptions& options,
                                              const EchoStore& store);

/// EchoModelType::memory of an IqModel that itself stores `model_bytes`.
EchoMemory iq_memory(const hw::AcquisitionPlan& plan,
                     const SimulationOptions& options,
                     bool tissue_moves,
                     double model_bytes);

/// EchoModelType::make of an IqModel.
template <class Model>
std::unique_ptr<const EchoModel> make_iq_model(const ScannedTissue& tissue,
                                               const hw::AcquisitionPlan& plan,
                                               const SimulationOptions& options,
                                               const EchoStore& store) {
  const auto make = [&] {
    return std::make_unique<Model>(tissue, ProbeOptics(plan, options), options);
  };
  return reuse_echoes(make, Model::kType, tissue, plan, options, store);
}

}  // namespace wobblebench::sim
