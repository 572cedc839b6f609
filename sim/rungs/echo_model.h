// EchoModel: the interface between a scan and the rungs of the ladder of fidelity, and their
// factory.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>

#include "hw/probe/acquisition_plan.h"
#include "sim/iq_sink.h"
#include "sim/options.h"
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
  /// Computes what the sticks of a volume share, on the threads of the options. Without it, the
  /// first stick does, and other threads wait for it.
  virtual void prepare(std::uint32_t /*volume*/) const {}
  /// `iq`, if given, is called with each stick's IQ samples. Throws std::logic_error if it is given
  /// to a rung that makes none.
  virtual StickMaker stick_maker(const IqSink& iq) const = 0;
};

/// Bytes of a model's largest arrays.
struct EchoMemory {
  double constructing = 0;  ///< at most, in the constructor
  double kept = 0;
};

/// Whether neither tissue nor the directions of the sticks change from volume to volume.
bool volumes_repeat(const hw::AcquisitionPlan& plan, bool tissue_moves);

/// The properties of a rung, before a model is made.
struct EchoModelType {
  std::string_view name;
  /// The next lower rung, whose effects this one models too; null: this is the lowest.
  const EchoModelType* lower;
  /// The effects that this rung adds, by their names in reports.
  std::span<const std::string_view> added_effects;
  /// Distance from a stick up to which surfaces contribute: what a TissueMap has to cover.
  double (*reach_m)(const hw::AcquisitionPlan& plan);
  EchoMemory (*memory)(const hw::AcquisitionPlan& plan,
                       const SimulationOptions& options,
                       bool tissue_moves);
  std::unique_ptr<const EchoModel> (*make)(const ScannedTissue& tissue,
                                           const hw::AcquisitionPlan& plan,
                                           const SimulationOptions& options);

  /// Effects have the names of sim/fidelity.h.
  bool models(std::string_view effect) const;
  /// Echoes are IQ samples, which a Receiver detects.
  bool makes_iq() const { return models("envelope"); }
};

/// Throws std::logic_error for `automatic`, which choose_fidelity() resolves.
const EchoModelType& echo_model_type(Rung rung);

/// The factory. Throws InvalidOption where the scene is too large for the rung.
std::unique_ptr<const EchoModel> make_echo_model(Rung rung,
                                                 const ScannedTissue& tissue,
                                                 const hw::AcquisitionPlan& plan,
                                                 const SimulationOptions& options);

}  // namespace wobblebench::sim
