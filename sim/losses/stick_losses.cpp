#include "sim/losses/stick_losses.h"

#include <algorithm>
#include <cmath>

#include "sim/losses/loss_kernels.h"
#include "sim/losses/losses.h"

namespace wobblebench::sim {

namespace {

double interpolated(std::span<const float> nodes, double position) {
  const auto last = static_cast<double>(nodes.size() - 1);
  const double within = std::clamp(position, 0.0, last);
  const auto node = std::min(static_cast<std::size_t>(within), nodes.size() - 2);
  const double share = within - static_cast<double>(node);
  return (1 - share) * static_cast<double>(nodes[node]) +
         share * static_cast<double>(nodes[node + 1]);
}

}  // namespace

StickLosses::StickLosses(const hw::AcquisitionPlan& plan,
                         const SimulationOptions& options,
                         const std::vector<phantoms::Material>& materials,
                         double spacing_m,
                         int samples)
    : options_(options),
      tissue_(plan, options, materials),
      band_(plan.probe()),
      spacing_m_(spacing_m),
      samples_(samples),
      visible_(visible_amplitude(plan, options)) {
  for (const auto& material : materials) {
    const double assumed_m_s = plan.acquisition().sound_speed_m_s;
    speed_ratio_.push_back(options.tissue_sound_speed ? assumed_m_s / material.sound_speed_m_s : 1);
    absorbs_ = absorbs_ || (options.attenuation && material.attenuation_db_per_cm_mhz > 0);
  }
}

void StickLosses::compute(const StickTrack& track, const ApertureCorrection& correction) {
  correction_ = correction;
  remaining_.clear();
  frequency_ratio_.clear();
  delay_m_.clear();
  at_interface_.assign(track.interfaces.size(), 0);
  apparent_from_m_.clear();
  keep_ = 0;
  visible_samples_ = samples_;
  Way way;
  for (std::size_t s = 0; s < track.stretches.size(); ++s) {
    const Stretch& stretch = track.stretches[s];
    apparent_from_m_.push_back(way.apparent_m);
    if (s > 0) cross(track, s - 1, way);
    const double ratio = speed_ratio(stretch.material);
    const double length_m = stretch.to_m - stretch.from_m;
    const double end_m = way.apparent_m + length_m * ratio;
    // The last stretch includes the last sample in spite of rounding.
    const bool is_last = s + 1 == track.stretches.size();
    const int end = is_last && ratio == 1 ? samples_ : samples_before(end_m);
    append(way, stretch, end);
    if (static_cast<int>(remaining_.size()) < end) break;
    way.nepers += tissue_.nepers_per_m(stretch.material) * length_m;
    way.apparent_m = end_m;
  }
  trim();
}

double StickLosses::level(const Way& way, double true_m) const {
  const double gain = band_.log_gain(way.nepers);
  if (correction_.empty()) {
    return way.lost ? 0 : way.transmitted * std::exp(gain - way.nepers);
  }
  const double narrow = std::max(std::log(way.transmitted) - way.nepers, -2 * kMostNepers);
  const double aside = interpolated(correction_.log_gain, true_m / correction_.step_m);
  return std::exp(std::min(narrow + gain + aside, 0.0));
}

void StickLosses::cross(const StickTrack& track, std::size_t interface, Way& way) {
  const Interface& crossed = track.interfaces[interface];
  at_interface_[interface] = level(way, crossed.range_m);
  if (at_interface_[interface] > visible_) {
    keep_ = samples_before(way.apparent_m + kBehindInterface_m);
  }
  const double through = tissue_.transmission(crossed);
  way.lost = way.lost || through < TissueLosses::kLeastTransmission;
  way.transmitted *= std::max(through, TissueLosses::kLeastTransmission);
}

int StickLosses::samples_before(double range_m) const {
  const double position = range_m / spacing_m_ - 0.5;
  const int whole = static_cast<int>(position);
  return std::clamp(whole < position ? whole + 1 : whole, 0, samples_);
}

void StickLosses::append(const Way& way, const Stretch& stretch, int end) {
  const int first = static_cast<int>(remaining_.size());
  if (end <= first) return;
  const double ratio = speed_ratio(stretch.material);
  const double nepers_per_m = tissue_.nepers_per_m(stretch.material) / ratio;
  const double to_first_m = (first + 0.5) * spacing_m_ - way.apparent_m;
  const double nepers = way.nepers + nepers_per_m * to_first_m;
  const double per_sample = nepers_per_m * spacing_m_;
  const LevelLine line{std::log(way.transmitted), nepers, per_sample};
  remaining_.resize(static_cast<std::size_t>(end));
  if (absorbs_) {
    frequency_ratio_.resize(static_cast<std::size_t>(end));
    fill_ramp(1 - band_.variance() * nepers,
              -band_.variance() * per_sample,
              BandLoss::kLowest,
              end - first,
              frequency_ratio_.data() + first);
  }
  if (correction_.empty()) {
    fill_even(line, way.transmitted, first);
    if (way.lost) visible_samples_ = std::min(visible_samples_, first);
    end_where_invisible(first);
  } else {
    fill_uneven(line, stretch.from_m + to_first_m / ratio, spacing_m_ / ratio, first);
  }
  if (options_.tissue_sound_speed) append_delays(stretch, way.apparent_m);
}

void StickLosses::fill_even(const LevelLine& line, double amplitude, int first) {
  const int count = static_cast<int>(remaining_.size()) - first;
  const double step = line.per_sample, variance = band_.variance();
  const double most = band_.most_nepers();
  const double until = step > 0 ? std::ceil((most - line.nepers) / step) : count;
  const int curved = static_cast<int>(std::clamp(until, 0.0, static_cast<double>(count)));
  const auto at = [&](double nepers) {
    return amplitude * std::exp(band_.log_gain(nepers) - nepers);
  };
  float* values = remaining_.data() + first;
  if (curved > 0) {
    // The logarithm's first difference is -step (1 - variance (n + step / 2)).
    const double ratio = std::exp(step * (variance * (line.nepers + 0.5 * step) - 1));
    fill_decay(at(line.nepers), ratio, std::exp(variance * step * step), curved, values);
  }
  if (curved < count) {
    const double ratio = std::exp(-BandLoss::kLowest * step);
    fill_decay(at(line.nepers + curved * step), ratio, 1, count - curved, values + curved);
  }
}

void StickLosses::fill_uneven(const LevelLine& line, double true_m, double true_step_m, int first) {
  const int count = static_cast<int>(remaining_.size()) - first;
  const double from = true_m / correction_.step_m, per_sample = true_step_m / correction_.step_m;
  float* values = remaining_.data() + first;
  std::fill_n(values, count, 0.0f);
  add_interpolated(correction_.log_gain, from, per_sample, count, values);
  fill_levels(line, band_.variance(), band_.most_nepers(), 2 * kMostNepers, count, values);
  if (!absorbs_) return;
  float* ratios = frequency_ratio_.data() + first;
  add_interpolated(correction_.frequency, from, per_sample, count, ratios);
  for (int i = 0; i < count; ++i) {
    ratios[i] = std::clamp(ratios[i], static_cast<float>(BandLoss::kLowest), 1.0f);
  }
}

void StickLosses::end_where_invisible(int first) {
  const int end = static_cast<int>(remaining_.size());
  if (visible_samples_ > first && is_visible(remaining_.back())) return;
  const auto from = remaining_.begin() + first;
  const auto visible = [this](float a) { return is_visible(a); };
  const auto cut = std::partition_point(from, remaining_.end(), visible) - remaining_.begin();
  visible_samples_ = std::min(visible_samples_, static_cast<int>(cut));
  remaining_.resize(static_cast<std::size_t>(std::max(visible_samples_, std::min(keep_, end))));
}

void StickLosses::trim() {
  if (!correction_.empty()) {
    const auto last = std::find_if(
        remaining_.rbegin(), remaining_.rend(), [this](float a) { return is_visible(a); });
    const auto size = remaining_.size();
    visible_samples_ = static_cast<int>(remaining_.rend() - last);
    remaining_.resize(std::min(size, static_cast<std::size_t>(std::max(visible_samples_, keep_))));
  }
  visible_samples_ = std::min(visible_samples_, static_cast<int>(remaining_.size()));
  if (absorbs_) frequency_ratio_.resize(remaining_.size());
  if (options_.tissue_sound_speed) delay_m_.resize(remaining_.size());
}

void StickLosses::append_delays(const Stretch& stretch, double from_m) {
  const double ratio = speed_ratio(stretch.material);
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
  return apparent_from_m_[s] + (true_m - stretch.from_m) * speed_ratio(stretch.material);
}

}  // namespace wobblebench::sim
