#include "sim/rungs/echo_model.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "base/parallel.h"
#include "phantoms/material.h"
#include "sim/losses/aperture_losses.h"
#include "sim/math/random.h"
#include "sim/optics/pulse_band.h"
#include "sim/rungs/field_model.h"
#include "sim/rungs/geometry_model.h"
#include "sim/rungs/reference_model.h"
#include "sim/rungs/scatterers_model.h"
#include "sim/speckle/iq_field.h"

namespace wobblebench::sim {

bool volumes_repeat(const hw::AcquisitionPlan& plan, bool tissue_moves) {
  return !tissue_moves && plan.acquisition().motor != hw::MotorMode::alternating;
}

hw::StickIndex stick_in_order(const hw::AcquisitionPlan& plan, std::uint32_t volume, int i) {
  const int lines = plan.acquisition().sticks_per_frame;
  const int first = i / (kFramesTogether * lines) * kFramesTogether;
  const int frames = std::min(kFramesTogether, plan.acquisition().frames_per_volume - first);
  const int within = i - first * lines;
  return {volume,
          static_cast<std::uint32_t>(first + within % frames),
          static_cast<std::uint32_t>(within / frames)};
}

bool EchoModelType::models(std::string_view effect) const {
  return std::find(added_effects.begin(), added_effects.end(), effect) != added_effects.end() ||
         (lower != nullptr && lower->models(effect));
}

const EchoModelType& echo_model_type(Rung rung) {
  switch (rung) {
    case Rung::geometry:
      return GeometryModel::kType;
    case Rung::field:
      return FieldModel::kType;
    case Rung::scatterers:
      return ScatterersModel::kType;
    case Rung::reference:
      return ReferenceModel::kType;
    case Rung::automatic:
      break;
  }
  throw std::logic_error("Rung: no such rung");
}

std::unique_ptr<const EchoModel> make_echo_model(Rung rung,
                                                 const ScannedTissue& tissue,
                                                 const hw::AcquisitionPlan& plan,
                                                 const SimulationOptions& options,
                                                 const EchoStore& store) {
  return echo_model_type(rung).make(tissue, plan, options, store);
}

namespace {

/// Upper bound of the true range of the last sample, in tissue of the built-in materials.
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
  ReusedEchoes(const EchoModelType& type,
               IqField echoes,
               const hw::AcquisitionPlan& plan,
               const SimulationOptions& options)
      : IqModel(plan, options), type_(type), echoes_(std::move(echoes)) {}

  const EchoModelType& type() const override { return type_; }
  IqMaker iq_maker() const override {
    return [this](const hw::StickIndex& index) { return echoes_.stick(index); };
  }

 private:
  const EchoModelType& type_;
  IqField echoes_;
};

void compute_echoes(const IqModel& source,
                    const hw::AcquisitionPlan& plan,
                    int threads,
                    IqField& echoes) {
  source.prepare(0);
  parallel_ranges(plan.sticks_per_volume(), threads, [&](int first, int last) {
    const IqMaker make = source.iq_maker();
    for (int i = first; i < last; ++i) {
      const hw::StickIndex index = stick_in_order(plan, 0, i);
      const auto iq = make(index);
      std::copy(iq.begin(), iq.end(), echoes.stick(index).begin());
    }
  });
}

}  // namespace

IqModel::IqModel(const hw::AcquisitionPlan& plan, const SimulationOptions& options)
    : plan_(plan), seed_(options.seed), receiver_(plan_, options, iq_oversampling(plan_)) {}

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
  if (options.clutter.has_haze()) model_bytes += iq_bytes(plan);  // its speckle
  const int kept = repeat ? 1 : RecentVolumes<VolumeCorrections>::kKept;
  const double losses =
      options.aperture_losses ? ApertureLosses::bytes(plan, deepest_m(plan, options), kept) : 0;
  if (repeat) return {model_bytes + iq_bytes(plan) + losses, iq_bytes(plan)};
  return {model_bytes + losses, model_bytes + losses};
}

std::unique_ptr<const EchoModel> reuse_echoes(const MakeIqModel& make,
                                              const EchoModelType& type,
                                              const ScannedTissue& tissue,
                                              const hw::AcquisitionPlan& plan,
                                              const SimulationOptions& options,
                                              const EchoStore& store) {
  if (!volumes_repeat(plan, !tissue.still())) return make();
  IqField echoes = make_iq_field(plan);
  if (!store.load || !store.load(echoes.values)) {
    compute_echoes(*make(), plan, options.threads, echoes);
    if (store.keep) store.keep(echoes.values);
  }
  return std::make_unique<ReusedEchoes>(type, std::move(echoes), plan, options);
}

}  // namespace wobblebench::sim
