#include "sim/echo/stick_propagation.h"

#include <algorithm>

#include "sim/beam/point_spread.h"
#include "sim/echo/iq_field.h"
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

TimedRay stick_ray(const hw::AcquisitionPlan& plan, const hw::StickIndex& index) {
  const auto time = plan.stick_time(plan.sequence(index)).time_since_epoch();
  return {plan.geometry().stick(plan.theta_rad(static_cast<int>(index.line)),
                                plan.motor_angle_rad(index)),
          std::chrono::duration<double>(time).count()};
}

StickPropagation::StickPropagation(const ScannedTissue& tissue,
                                   const hw::AcquisitionPlan& plan,
                                   const SimulationOptions& options,
                                   Surfaces surfaces)
    : tissue_(&tissue),
      plan_(plan),
      options_(options),
      surfaces_(surfaces),
      samples_(plan.acquisition().samples_per_stick * iq_oversampling(plan)),
      spacing_m_(plan.sample_spacing_m() / iq_oversampling(plan)),
      visible_(visible_amplitude(plan, options)),
      depth_m_(plan.acquisition().depth_m),
      losses_(plan, options, tissue.materials, spacing_m_, samples_) {
  if (options.tissue_sound_speed) depth_m_ *= fastest_ratio(tissue, plan);
}

void StickPropagation::follow(const hw::StickIndex& index) {
  line_ = stick_ray(plan_, index);
  sim::follow(*tissue_, line_, depth_m_, track_, surfaces_);
  losses_.compute(track_);
}

void StickPropagation::add_specular_echoes(std::span<std::complex<float>> iq) const {
  if (!options_.interface_echo) return;
  const auto material = [&](phantoms::MaterialIndex index) -> const phantoms::Material& {
    return tissue_->materials[static_cast<std::size_t>(index)];
  };
  for (std::size_t i = 0; i < track_.interfaces.size(); ++i) {
    const Interface& at = track_.interfaces[i];
    const double arriving = losses_.at_interface()[i];
    if (arriving <= visible_) return;
    const double echo =
        arriving *
        specular_echo(material(at.before), material(at.behind), at.cos_incidence, options_);
    if (echo <= visible_) continue;
    add_reflector(iq, spacing_m_, losses_.apparent_m(track_, at.range_m), echo, plan_);
  }
}

}  // namespace wobblebench::sim
