#include "sim/rungs/stick_propagation.h"

#include <algorithm>
#include <cstdint>

#include "sim/losses/losses.h"
#include "sim/receive/receiver.h"
#include "sim/speckle/iq_field.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

namespace {

double fastest_ratio(const ScannedTissue& tissue, const hw::AcquisitionPlan& plan) {
  double ratio = 1;
  for (const auto& material : tissue.materials) {
    ratio = std::max(ratio, material.sound_speed_m_s / plan.acquisition().sound_speed_m_s);
  }
  return ratio;
}

}  // namespace

StickPath visible_path(const TimedRay& line, double spacing_m, const StickLosses& losses) {
  int last = losses.visible_samples();
  for (const InterfaceFront& front : losses.fronts()) last = std::max(last, front.end);
  const auto count = static_cast<std::size_t>(last);
  const std::span<const float> delay_m = losses.delay_m();
  const std::span<const float> frequency_ratio = losses.frequency_ratio();
  return {line,
          spacing_m,
          std::span(losses.remaining()).first(count),
          delay_m.empty() ? delay_m : delay_m.first(count),
          frequency_ratio.empty() ? frequency_ratio : frequency_ratio.first(count),
          losses.fronts()};
}

StickPropagation::StickPropagation(const ScannedTissue& tissue,
                                   const ProbeOptics& optics,
                                   const SimulationOptions& options,
                                   Surfaces surfaces)
    : tissue_(&tissue),
      plan_(optics.plan()),
      geometry_(plan_.geometry()),
      options_(options),
      surfaces_(surfaces),
      samples_(optics.iq_samples()),
      spacing_m_(optics.iq_spacing_m()),
      visible_(visible_amplitude(plan_, options)),
      depth_m_(plan_.acquisition().depth_m),
      losses_(plan_, options, tissue.materials, spacing_m_, samples_),
      uneven_(tissue, options, spacing_m_),
      reverberation_(plan_, options, tissue.materials, spacing_m_) {
  if (options.tissue_sound_speed) depth_m_ *= fastest_ratio(tissue, plan_);
  if (has_aperture_losses(options, tissue.materials)) {
    aperture_ = std::make_shared<const ApertureLosses>(tissue, optics, options, depth_m_);
  }
  if (options.clutter.has_haze()) {
    haze_ = std::make_shared<const Haze>(tissue, optics, options, depth_m_);
  }
}

void StickPropagation::follow(const hw::StickIndex& index) {
  index_ = index;
  line_ = stick_ray(plan_, geometry_, index);
  sim::follow(*tissue_, line_, depth_m_, track_, surfaces_);
  if (aperture_ == nullptr) return losses_.compute(track_);
  if (volume_ == nullptr || volume_->number() != index.volume) {
    volume_ = aperture_->volume(index.volume);
  }
  losses_.compute(track_, volume_->of(index));
}

void StickPropagation::add_specular_echoes(std::span<std::complex<float>> iq) const {
  if (!options_.interface_echo) return;
  const auto material = [&](phantoms::MaterialIndex index) -> const phantoms::Material& {
    return tissue_->materials[static_cast<std::size_t>(index)];
  };
  for (std::size_t i = 0; i < track_.interfaces.size(); ++i) {
    const Interface& at = track_.interfaces[i];
    const double arriving = losses_.at_interface()[i];
    if (arriving <= visible_) continue;
    const double echo =
        arriving *
        specular_echo(material(at.before), material(at.behind), at.cos_incidence, options_);
    if (echo <= visible_) continue;
    add_reflector(iq, spacing_m_, losses_.apparent_m(track_, at.range_m), echo, plan_);
  }
}

void StickPropagation::vary_tissue(std::span<std::complex<float>> iq) const {
  // Behind the last echo is at most the end of its pulse.
  constexpr std::size_t kPulse = 64;
  uneven_.apply(
      line_, track_, losses_, iq.first(std::min(iq.size(), losses_.remaining().size() + kPulse)));
}

void StickPropagation::add_clutter(std::span<std::complex<float>> iq) {
  reverberation_.add(track_, losses_, iq);
  if (haze_ == nullptr) return;
  if (haze_volume_ == nullptr || haze_volume_->number() != index_.volume) {
    haze_volume_ = haze_->volume(index_.volume);
  }
  haze_->add(*haze_volume_, index_, iq);
}

namespace {

constexpr std::uint64_t kSticks = 97;  ///< a prime, so that they lie on many lines

}  // namespace

FrequencyCourse highest_frequency(const ScannedTissue& tissue,
                                  const ProbeOptics& optics,
                                  const SimulationOptions& options) {
  const hw::AcquisitionPlan& plan = optics.plan();
  SimulationOptions axis_alone = options;
  axis_alone.aperture_losses = false;
  axis_alone.clutter = {};
  StickPropagation propagation(tissue, optics, axis_alone, Surfaces::crossed);
  FrequencyCourse course{propagation.spacing_m(), {}};
  const auto sticks = static_cast<std::uint64_t>(plan.sticks_per_volume());
  for (std::uint64_t i = 0; i < kSticks; ++i) {
    propagation.follow(plan.index(sticks * i / kSticks));
    const std::span<const float> ratio = propagation.path().frequency_ratio;
    if (course.ratio.size() < ratio.size()) course.ratio.resize(ratio.size(), 0.0f);
    for (std::size_t at = 0; at < ratio.size(); ++at) {
      course.ratio[at] = std::max(course.ratio[at], ratio[at]);
    }
  }
  return course;
}

}  // namespace wobblebench::sim
