#include "sim/receive/losses.h"

#include <algorithm>
#include <cmath>

#include "sim/math/simd.h"

namespace wobblebench::sim {

namespace {

constexpr double kCentimetre = 1e-2;
/// Echoes so far below the noise or the dynamic range are invisible.
constexpr double kInvisible_db = 20;

/// Two-way loss for a centimetre of range.
double two_way_db_per_cm(double alpha_db_per_cm_mhz, double frequency_mhz) {
  return 2 * alpha_db_per_cm_mhz * frequency_mhz;
}

/// Geometric series amplitude * factor^i, eight values at a time.
WOBBLEBENCH_SIMD void decay(double amplitude, double factor, int count, float* __restrict values) {
  constexpr int kLanes = 8;
  double lanes[kLanes], power = 1;
  for (double& lane : lanes) {
    lane = amplitude * power;
    power *= factor;
  }
  int first = 0;
  for (; first + kLanes <= count; first += kLanes) {
    for (int i = 0; i < kLanes; ++i) {
      values[first + i] = static_cast<float>(lanes[i]);
      lanes[i] *= power;
    }
  }
  for (int i = 0; first + i < count; ++i) values[first + i] = static_cast<float>(lanes[i]);
}

}  // namespace

double roughness(const phantoms::Material& before, const phantoms::Material& behind) {
  return std::max(before.roughness, behind.roughness);
}

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

double visible_amplitude(const hw::AcquisitionPlan& plan, const SimulationOptions& options) {
  if (options.noise_db > kZeroAmplitude_db)
    return amplitude_of_db(options.noise_db - kInvisible_db);
  if (options.output == hw::SampleScale::linear_envelope) return 0;
  const double invisible_db = options.full_scale_db - options.dynamic_range_db - kInvisible_db;
  return amplitude_of_db(invisible_db) / time_gain(plan, options, plan.acquisition().depth_m);
}

StickLosses::StickLosses(const hw::AcquisitionPlan& plan,
                         const SimulationOptions& options,
                         const std::vector<phantoms::Material>& materials,
                         double spacing_m,
                         int samples)
    : materials_(&materials),
      options_(options),
      spacing_m_(spacing_m),
      samples_(samples),
      visible_(visible_amplitude(plan, options)) {
  const double frequency_mhz = plan.probe().center_frequency_hz / kMegahertz;
  for (const auto& material : materials) {
    Medium medium;
    if (options.tissue_sound_speed) {
      medium.speed_ratio = plan.acquisition().sound_speed_m_s / material.sound_speed_m_s;
    }
    const double alpha = options.attenuation ? material.attenuation_db_per_cm_mhz : 0;
    medium.nepers_per_m = two_way_db_per_cm(alpha, frequency_mhz) / kCentimetre /
                          medium.speed_ratio * std::log(10.0) / 20;
    medium.factor_per_sample = std::exp(-medium.nepers_per_m * spacing_m);
    media_.push_back(medium);
  }
}

void StickLosses::compute(const StickTrack& track) {
  remaining_.clear();
  delay_m_.clear();
  at_interface_.assign(track.interfaces.size(), 0);
  apparent_from_m_.clear();
  double level = 1, apparent_m = 0;
  for (std::size_t s = 0; s < track.stretches.size(); ++s) {
    const Stretch& stretch = track.stretches[s];
    apparent_from_m_.push_back(apparent_m);
    if (s > 0) {
      at_interface_[s - 1] = level;
      if (options_.transmission_loss) level *= transmission(track.interfaces[s - 1]);
    }
    const Medium& here = medium(stretch.material);
    const double end_m = apparent_m + (stretch.to_m - stretch.from_m) * here.speed_ratio;
    // The last stretch includes the last sample in spite of rounding.
    const bool is_last = s + 1 == track.stretches.size();
    const int end = is_last && here.speed_ratio == 1 ? samples_ : samples_before(end_m);
    append_decay(here, level, apparent_m, end);
    if (options_.tissue_sound_speed) append_delays(stretch, apparent_m);
    level *= std::exp(-here.nepers_per_m * (end_m - apparent_m));
    apparent_m = end_m;
    if (level <= visible_ || static_cast<int>(remaining_.size()) < end) return;
  }
}

double StickLosses::transmission(const Interface& crossed) const {
  const double r = reflection(materials_->at(static_cast<std::size_t>(crossed.before)),
                              materials_->at(static_cast<std::size_t>(crossed.behind)),
                              crossed.cos_incidence);
  return 1 - r * r;
}

int StickLosses::samples_before(double range_m) const {
  const double position = range_m / spacing_m_ - 0.5;
  const int whole = static_cast<int>(position);
  return std::clamp(whole < position ? whole + 1 : whole, 0, samples_);
}

void StickLosses::append_decay(const Medium& medium, double level, double from_m, int end) {
  const int first = static_cast<int>(remaining_.size());
  if (end <= first) return;
  remaining_.resize(static_cast<std::size_t>(end));
  const double to_first_m = (first + 0.5) * spacing_m_ - from_m;
  decay(level * std::exp(-medium.nepers_per_m * to_first_m),
        medium.factor_per_sample,
        end - first,
        remaining_.data() + first);
  const auto is_visible = [this](float a) { return static_cast<double>(a) > visible_; };
  if (is_visible(remaining_.back())) return;
  remaining_.erase(std::partition_point(remaining_.begin() + first, remaining_.end(), is_visible),
                   remaining_.end());
}

void StickLosses::append_delays(const Stretch& stretch, double from_m) {
  const double ratio = medium(stretch.material).speed_ratio;
  for (std::size_t i = delay_m_.size(); i < remaining_.size(); ++i) {
    const double here_m = (static_cast<double>(i) + 0.5) * spacing_m_;
    const double true_m = stretch.from_m + (here_m - from_m) / ratio;
    delay_m_.push_back(static_cast<float>(here_m - true_m));
  }
}

double StickLosses::apparent_m(const StickTrack& track, double true_m) const {
  if (!options_.tissue_sound_speed) return true_m;
  std::size_t s = 0;
  while (s + 1 < apparent_from_m_.size() && true_m >= track.stretches[s + 1].from_m) ++s;
  const Stretch& stretch = track.stretches[s];
  return apparent_from_m_[s] + (true_m - stretch.from_m) * medium(stretch.material).speed_ratio;
}

}  // namespace wobblebench::sim
