#include "sim/losses.h"

#include <algorithm>

namespace wobblebench::sim {

namespace {

constexpr double kCentimetre = 1e-2;
/// What lies this far below the noise, or below the display, is left out.
constexpr double kBelowSight_db = 20;

/// dB lost there and back over a centimetre of range.
double two_way_db_per_cm(double alpha_db_per_cm_mhz, double frequency_mhz) {
  return 2 * alpha_db_per_cm_mhz * frequency_mhz;
}

double roughness(const phantoms::Material& before, const phantoms::Material& behind) {
  return std::max(before.roughness, behind.roughness);
}

}  // namespace

double reflection(const phantoms::Material& before,
                  const phantoms::Material& behind,
                  double cos_incidence) {
  const double cos_in = std::clamp(cos_incidence, 0.0, 1.0);
  const double ratio = behind.sound_speed_m_s / before.sound_speed_m_s;
  const double sin2_through = ratio * ratio * (1 - cos_in * cos_in);
  if (sin2_through >= 1) return 1;
  const double in = behind.impedance_rayl * cos_in;
  const double through = before.impedance_rayl * std::sqrt(1 - sin2_through);
  return (in - through) / (in + through);
}

double diffuse_echo(const phantoms::Material& before,
                    const phantoms::Material& behind,
                    double cos_incidence) {
  return roughness(before, behind) * std::abs(reflection(before, behind, cos_incidence)) *
         std::clamp(cos_incidence, 0.0, 1.0);
}

double specular_echo(const phantoms::Material& before,
                     const phantoms::Material& behind,
                     double cos_incidence,
                     const SimulationOptions& options) {
  // -3 dB of amplitude at half the width: exp(-ln(sqrt 2) (2 angle / width)^2).
  const double angle = std::acos(std::clamp(cos_incidence, 0.0, 1.0));
  const double relative = 2 * angle / options.specular_width_rad;
  const double lobe = std::exp(-0.5 * std::log(2.0) * relative * relative);
  return (1 - roughness(before, behind)) * lobe *
         std::abs(reflection(before, behind, cos_incidence));
}

double time_gain(const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options,
                 double range_m) {
  const double db_per_cm =
      two_way_db_per_cm(options.tgc_db_per_cm_mhz, plan.probe().center_frequency_hz / kMegahertz);
  return amplitude_of_db(db_per_cm * range_m / kCentimetre);
}

double lost_amplitude(const hw::AcquisitionPlan& plan, const SimulationOptions& options) {
  if (options.noise_db > kSilent_db) return amplitude_of_db(options.noise_db - kBelowSight_db);
  if (options.output == hw::SampleScale::linear_envelope) return 0;
  const double darkest_db = options.full_scale_db - options.dynamic_range_db - kBelowSight_db;
  return amplitude_of_db(darkest_db) / time_gain(plan, options, plan.acquisition().depth_m);
}

StickLosses::StickLosses(const hw::AcquisitionPlan& plan,
                         const SimulationOptions& options,
                         const std::vector<phantoms::Material>& materials,
                         double spacing_m,
                         int samples)
    : materials_(&materials),
      options_(options),
      assumed_speed_m_s_(plan.acquisition().sound_speed_m_s),
      frequency_mhz_(plan.probe().center_frequency_hz / kMegahertz),
      spacing_m_(spacing_m),
      samples_(samples),
      lost_(lost_amplitude(plan, options)) {}

double StickLosses::speed_ratio(phantoms::MaterialIndex material) const {
  if (!options_.tissue_sound_speed) return 1;
  return assumed_speed_m_s_ / materials_->at(static_cast<std::size_t>(material)).sound_speed_m_s;
}

void StickLosses::compute(const StickTrack& track) {
  left_.clear();
  delay_m_.clear();
  at_interface_.assign(track.interfaces.size(), 0);
  apparent_from_m_.clear();
  double level = 1, apparent_m = 0;
  for (std::size_t s = 0; s < track.stretches.size(); ++s) {
    const Stretch& stretch = track.stretches[s];
    const auto& material = materials_->at(static_cast<std::size_t>(stretch.material));
    apparent_from_m_.push_back(apparent_m);
    if (s > 0) {
      const Interface& crossed = track.interfaces[s - 1];
      at_interface_[s - 1] = level;
      if (options_.transmission_loss) {
        const double r = reflection(materials_->at(static_cast<std::size_t>(crossed.before)),
                                    material,
                                    crossed.cos_incidence);
        level *= 1 - r * r;
      }
    }
    const double ratio = speed_ratio(stretch.material);
    const double alpha = options_.attenuation ? material.attenuation_db_per_cm_mhz : 0;
    const double db_per_m = two_way_db_per_cm(alpha, frequency_mhz_) / kCentimetre / ratio;
    const double end_m = apparent_m + (stretch.to_m - stretch.from_m) * ratio;
    // The rim of the last stretch belongs to it, whatever rounding says.
    const bool is_last = s + 1 == track.stretches.size();
    const double limit_m = is_last && ratio == 1 ? samples_ * spacing_m_ : end_m;
    const double per_sample = amplitude_of_db(-db_per_m * spacing_m_);
    double here_m = (static_cast<double>(left_.size()) + 0.5) * spacing_m_;
    double amplitude = level * amplitude_of_db(-db_per_m * (here_m - apparent_m));
    while (here_m < limit_m && static_cast<int>(left_.size()) < samples_) {
      if (amplitude <= lost_) return;
      left_.push_back(static_cast<float>(amplitude));
      if (options_.tissue_sound_speed) {
        const double true_m = stretch.from_m + (here_m - apparent_m) / ratio;
        delay_m_.push_back(static_cast<float>(here_m - true_m));
      }
      amplitude *= per_sample;
      here_m = (static_cast<double>(left_.size()) + 0.5) * spacing_m_;
    }
    level *= amplitude_of_db(-db_per_m * (end_m - apparent_m));
    apparent_m = end_m;
    if (level <= lost_) return;
  }
}

double StickLosses::apparent_m(const StickTrack& track, double true_m) const {
  if (!options_.tissue_sound_speed) return true_m;
  std::size_t s = 0;
  while (s + 1 < apparent_from_m_.size() && true_m >= track.stretches[s + 1].from_m) ++s;
  const Stretch& stretch = track.stretches[s];
  return apparent_from_m_[s] + (true_m - stretch.from_m) * speed_ratio(stretch.material);
}

}  // namespace wobblebench::sim
