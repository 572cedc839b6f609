#include "sim/rungs/iq_model.h"

#include <algorithm>

#include "base/parallel.h"
#include "phantoms/material.h"
#include "sim/losses/aperture_losses.h"
#include "sim/math/random.h"
#include "sim/optics/point_spread.h"
#include "sim/speckle/iq_field.h"
#include "sim/stick_order.h"

namespace wobblebench::sim {

namespace {

/// True range of the last sample at most, in tissue of the built-in materials.
double deepest_m(const hw::AcquisitionPlan& plan, const SimulationOptions& options) {
  const auto& acquisition = plan.acquisition();
  double fastest_m_s = acquisition.sound_speed_m_s;
  if (options.tissue_sound_speed) {
    for (const auto& material : phantoms::material_table()) {
      fastest_m_s = std::max(fastest_m_s, material.sound_speed_m_s);
    }
  }
  return acquisition.depth_m * fastest_m_s / acquisition.sound_speed_m_s;
}

/// The noiseless echoes of one volume, used for every volume.
class ReusedEchoes final : public IqModel {
 public:
  ReusedEchoes(const IqModel& source,
               const hw::AcquisitionPlan& plan,
               const SimulationOptions& options)
      : IqModel(plan, options), type_(source.type()), echoes_(make_iq_field(plan)) {
    source.prepare(0);
    parallel_ranges(plan.sticks_per_volume(), options.threads, [&](int first, int last) {
      const IqMaker make = source.iq_maker();
      for (int i = first; i < last; ++i) {
        const hw::StickIndex index = stick_in_order(plan, 0, i);
        const auto iq = make(index);
        std::copy(iq.begin(), iq.end(), echoes_.stick(index).begin());
      }
    });
  }

  const EchoModelType& type() const override { return type_; }
  IqMaker iq_maker() const override {
    return [this](const hw::StickIndex& index) { return echoes_.stick(index); };
  }

 private:
  const EchoModelType& type_;
  IqField echoes_;
};

}  // namespace

IqModel::IqModel(const hw::AcquisitionPlan& plan, const SimulationOptions& options)
    : plan_(plan), seed_(options.seed), receiver_(plan, options, iq_oversampling(plan)) {}

StickMaker IqModel::stick_maker(const IqSink& sink) const {
  const auto sticks = static_cast<std::uint64_t>(plan_.sticks_per_volume());
  return [this,
          sticks,
          sink,
          make = iq_maker(),
          receiver = receiver_,
          noisy = std::vector<std::complex<float>>()](std::uint64_t sequence,
                                                      std::span<float> samples) mutable {
    const auto noise_key =
        random_key(seed_, RandomStream::noise, sequence / sticks, sequence % sticks);
    const hw::StickIndex index = plan_.index(sequence);
    const auto iq = make(index);
    if (sink) {
      receiver.add_noise(iq, noise_key, noisy);
      sink(index, noisy);
    }
    receiver.detect(iq, noise_key, samples);
  };
}

EchoMemory iq_memory(const hw::AcquisitionPlan& plan,
                     const SimulationOptions& options,
                     bool tissue_moves,
                     double model_bytes) {
  const bool repeat = volumes_repeat(plan, tissue_moves);
  const int kept = repeat ? 1 : ApertureLosses::kRecent;
  const double losses =
      options.aperture_losses ? ApertureLosses::bytes(plan, deepest_m(plan, options), kept) : 0;
  if (repeat) return {model_bytes + iq_bytes(plan) + losses, iq_bytes(plan)};
  return {model_bytes + losses, model_bytes + losses};
}

std::unique_ptr<const EchoModel> reuse_echoes(std::unique_ptr<const IqModel> model,
                                              const ScannedTissue& tissue,
                                              const hw::AcquisitionPlan& plan,
                                              const SimulationOptions& options) {
  if (!volumes_repeat(plan, !tissue.still())) return model;
  return std::make_unique<ReusedEchoes>(*model, plan, options);
}

}  // namespace wobblebench::sim
