#include "sim/echo/stick_echoes.h"

#include <algorithm>
#include <cmath>

#include "sim/echo/reference_scene.h"
#include "sim/math/simd.h"
#include "sim/scatterers/scatterer_field.h"

namespace wobblebench::sim {

namespace {

/// Half the diagonal of a hash cell of scatterers, at most, and what its sheets are thick.
constexpr double kScattererReach_m = 2e-3;

double fastest_ratio(const ScannedTissue& subject, const hw::AcquisitionPlan& plan) {
  double ratio = 1;
  for (const auto& material : subject.materials) {
    ratio = std::max(ratio, material.sound_speed_m_s / plan.acquisition().sound_speed_m_s);
  }
  return ratio;
}

WOBBLEBENCH_SIMD void scale_by_root(const float* even,
                                    const float* power,
                                    int count,
                                    float* __restrict parts) {
  for (int i = 0; i < count; ++i) {
    const std::ptrdiff_t at = 2 * static_cast<std::ptrdiff_t>(i);
    const float amplitude = std::sqrt(power[i]);
    parts[at] = even[at] * amplitude;
    parts[at + 1] = even[at + 1] * amplitude;
  }
}

}  // namespace

TimedRay sightline(const hw::AcquisitionPlan& plan, const hw::StickIndex& index) {
  const auto time = plan.stick_time(plan.sequence(index)).time_since_epoch();
  return {plan.geometry().stick(plan.theta_rad(static_cast<int>(index.line)),
                                plan.motor_angle_rad(index)),
          std::chrono::duration<double>(time).count()};
}

double StickEchoes::reach_m(const hw::AcquisitionPlan& plan, Rung rung) {
  if (rung == Rung::geometry) return 0;
  return rung == Rung::field ? MeanPower::reach_m(plan) : kScattererReach_m;
}

StickEchoes::StickEchoes(const ScannedTissue& subject,
                         const hw::AcquisitionPlan& plan,
                         const SimulationOptions& options,
                         Rung rung)
    : subject_(subject),
      plan_(plan),
      options_(options),
      rung_(rung),
      samples_(plan.acquisition().samples_per_stick * iq_oversampling(plan)),
      spacing_m_(plan.sample_spacing_m() / iq_oversampling(plan)),
      faintest_(lost_amplitude(plan, options)),
      fresh_{{},
             StickLosses(plan, options, subject_.materials, spacing_m_, samples_),
             MeanPower(
                 plan, options, subject_.materials, spacing_m_, samples_, subject.map->reach_m()),
             std::vector<float>(static_cast<std::size_t>(samples_))} {
  depth_m_ = plan.acquisition().depth_m;
  if (options.tissue_sound_speed) depth_m_ *= fastest_ratio(subject, plan);
  if (rung == Rung::field) {
    if (options.speckle) speckle_ = homogeneous_speckle(plan, options.seed, options.threads);
  } else if (rung == Rung::scatterers) {
    scatterers_ = std::make_unique<ScattererField>(subject_, plan, options);
  } else {
    reference_ = std::make_unique<ReferenceScene>(subject_, plan, options);
  }
}

StickEchoes::~StickEchoes() = default;

void StickEchoes::make(const hw::StickIndex& index,
                       Worker& worker,
                       std::span<std::complex<float>> iq) const {
  const TimedRay line = sightline(plan_, index);
  follow(subject_, line, depth_m_, worker.track, surfaces(rung_));
  worker.losses.compute(worker.track);
  if (rung_ == Rung::field) {
    modulate_speckle(index, worker, iq);
  } else {
    std::fill(iq.begin(), iq.end(), std::complex<float>(0));
    const StickPath way{line, spacing_m_, worker.losses.left(), worker.losses.delay_m()};
    if (scatterers_) scatterers_->add_echoes(way, iq);
    if (reference_) reference_->add_echoes(way, iq);
  }
  if (options_.interface_echo) add_specular(worker, iq);
}

void StickEchoes::modulate_speckle(const hw::StickIndex& index,
                                   Worker& worker,
                                   std::span<std::complex<float>> iq) const {
  if (!worker.power.compute(worker.track, worker.losses, worker.mean_power)) {
    std::fill(iq.begin(), iq.end(), std::complex<float>(0));
    return;
  }
  if (!options_.speckle) {
    std::transform(worker.mean_power.begin(), worker.mean_power.end(), iq.begin(), [](float power) {
      return std::complex<float>(std::sqrt(power));
    });
    return;
  }
  const auto even = speckle_.stick(static_cast<int>(index.frame), static_cast<int>(index.line));
  scale_by_root(reinterpret_cast<const float*>(even.data()),
                worker.mean_power.data(),
                samples_,
                reinterpret_cast<float*>(iq.data()));
}

void StickEchoes::add_specular(const Worker& worker, std::span<std::complex<float>> iq) const {
  const auto material = [&](phantoms::MaterialIndex index) -> const phantoms::Material& {
    return subject_.materials[static_cast<std::size_t>(index)];
  };
  for (std::size_t i = 0; i < worker.track.interfaces.size(); ++i) {
    const Interface& at = worker.track.interfaces[i];
    const double arriving = worker.losses.at_interface()[i];
    if (arriving <= faintest_) return;
    const double echo =
        arriving *
        specular_echo(material(at.before), material(at.behind), at.cos_incidence, options_);
    if (echo <= faintest_) continue;
    add_reflector(iq, spacing_m_, worker.losses.apparent_m(worker.track, at.range_m), echo, plan_);
  }
}

}  // namespace wobblebench::sim
