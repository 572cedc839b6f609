#include "sim/rungs/stick_propagation.h"

#include <algorithm>

#include "sim/losses/losses.h"
#include "sim/optics/point_spread.h"
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
  const auto count = static_cast<std::size_t>(losses.visible_samples());
  const std::span<const float> delay_m = losses.delay_m();
  const std::span<const float> frequency_ratio = losses.frequency_ratio();
  return {line,
          spacing_m,
          std::span(losses.remaining()).first(count),
          delay_m.empty() ? delay_m : delay_m.first(count),
          frequency_ratio.empty() ? frequency_ratio : frequency_ratio.first(count)};
}

StickPropagation::StickPropagation(const ScannedTissue& tissue,
                                   const hw::AcquisitionPlan& plan,
                                   const SimulationOptions& options,
                                   Surfaces surfaces)
    : tissue_(&tissue),
      plan_(plan),
      geometry_(plan.geometry()),
      options_(options),
      surfaces_(surfaces),
      samples_(plan.acquisition().samples_per_stick * iq_oversampling(plan)),
      spacing_m_(plan.sample_spacing_m() / iq_oversampling(plan)),
      visible_(visible_amplitude(plan, options)),
      depth_m_(plan.acquisition().depth_m),
      losses_(plan, options, tissue.materials, spacing_m_, samples_) {
  if (options.tissue_sound_speed) depth_m_ *= fastest_ratio(tissue, plan);
  if (has_aperture_losses(options, tissue.materials)) {
    aperture_ = std::make_shared<const ApertureLosses>(tissue, plan, options, depth_m_);
  }
}

void StickPropagation::follow(const hw::StickIndex& index) {
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

}  // namespace wobblebench::sim
