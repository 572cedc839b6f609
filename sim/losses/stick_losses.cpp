#include "sim/losses/stick_losses.h"

#include <algorithm>
#include <cmath>

#include "sim/math/fast_math.h"
#include "sim/receive/receiver.h"

namespace wobblebench::sim {

/// The logarithm of an amplitude along a stretch: BandLoss::log_gain(n) - n - reflected, where n =
/// nepers + i * per_sample at sample i.
struct StickLosses::LevelLine {
  double reflected = 0;
  double nepers = 0;  ///< at the first sample
  double per_sample = 0;

  double at(int sample) const { return nepers + sample * per_sample; }
  /// Calls `fill(first, end, piece)` for each run of the `count` samples within one piece.
  template <class Fill>
  void for_pieces(const BandLoss& band, int count, const Fill& fill) const {
    for (int first = 0, end = 0; first < count; first = end) {
      const BandLoss::Piece& piece = band.piece(at(first));
      const double left = per_sample > 0 ? std::ceil((piece.to - at(first)) / per_sample) : count;
      end = static_cast<int>(std::clamp<double>(first + left, first + 1, count));
      fill(first, end, piece);
    }
  }
};

namespace {

/// values[i] = amplitude * ratio^i * change^(i (i - 1) / 2), eight values at a time: the ratio of
/// values eight apart changes by the factor change^64 from one step to the next.
WOBBLEBENCH_SIMD void fill_decay(
    double amplitude, double ratio, double change, int count, float* __restrict values) {
  constexpr int kLanes = 8;
  const double change4 = change * change * change * change;
  const double change8 = change4 * change4, change16 = change8 * change8;
  const double change28 = change16 * change8 * change4;
  const double change32 = change16 * change16, change64 = change32 * change32;
  double lanes[kLanes], ratios[kLanes];
  for (int j = 0; j < kLanes; ++j) {
    lanes[j] = amplitude;
    const double ratio2 = ratio * ratio, ratio4 = ratio2 * ratio2;
    ratios[j] = ratio4 * ratio4 * change28;
    amplitude *= ratio;
    ratio *= change;
  }
  int first = 0;
  for (; first + kLanes <= count; first += kLanes) {
    for (int j = 0; j < kLanes; ++j) {
      values[first + j] = static_cast<float>(lanes[j]);
      lanes[j] *= ratios[j];
      ratios[j] *= change64;
    }
  }
  for (int j = 0; first + j < count; ++j) values[first + j] = static_cast<float>(lanes[j]);
}

/// values[i] = from + i * per_sample, at least `least`.
WOBBLEBENCH_SIMD void fill_ramp(
    double from, double per_sample, double least, int count, float* __restrict values) {
  for (int i = 0; i < count; ++i) {
    const double value = from + i * per_sample;
    values[i] = static_cast<float>(value < least ? least : value);
  }
}

/// values[i] += from + i * per_sample.
WOBBLEBENCH_SIMD void add_ramp(double from,
                               double per_sample,
                               int count,
                               float* __restrict values) {
  for (int i = 0; i < count; ++i) values[i] += static_cast<float>(from + i * per_sample);
}

/// values[i] = exp of the logarithm of the amplitude at f0, narrow - i * step, but at least
/// -most_narrow, plus the band's gain along a piece and plus values[i]; at most 1, at least 1e-35.
/// `from`: nepers of the first sample, from the beginning of the piece on.
WOBBLEBENCH_SIMD void fill_levels(double narrow,
                                  double from,
                                  double step,
                                  const BandLoss::Piece& piece,
                                  double most_narrow,
                                  int count,
                                  float* __restrict values) {
  constexpr float kLowest = -80;  // 1e-35 is a normal number
  const double gain = piece.gain, slope = piece.slope, curvature = piece.curvature;
  for (int i = 0; i < count; ++i) {
    const double nepers = from + i * step;
    const double here = narrow - i * step;
    const double bounded = here < -most_narrow ? -most_narrow : here;
    const double level = bounded + gain + (slope + curvature * nepers) * nepers;
    const float log_level = static_cast<float>(level) + values[i];
    const float least = log_level < kLowest ? kLowest : log_level;
    values[i] = fast_exp(least > 0.0f ? 0.0f : least);
  }
}

/// Nepers between two nodes that the correction takes for spread evenly, so that it changes evenly
/// where the axis loses nothing.
constexpr double kEvenNepers = 0.1;

/// Interfaces that pass more have no front: half of their echo, behind them, loses less than 2 dB.
constexpr double kFrontTransmission = 0.8;

double reflected_nepers(double transmission) {
  return -std::log(std::max(transmission, TissueLosses::kLeastTransmission));
}

}  // namespace

const InterfaceFront* front_at(std::span<const InterfaceFront> fronts,
                               phantoms::MaterialIndex before,
                               phantoms::MaterialIndex behind,
                               int sample) {
  const InterfaceFront* found = nullptr;
  for (const InterfaceFront& front : fronts) {
    if (front.before != before || front.behind != behind) continue;
    if (front.first <= sample && sample < front.end) found = &front;
  }
  return found;
}

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
  fronts_.clear();
  apparent_from_m_.clear();
  if (!correction.empty()) find_losses_at_nodes(track);
  keep_ = 0;
  visible_samples_ = samples_;
  PathState path;
  for (std::size_t s = 0; s < track.stretches.size(); ++s) {
    const Stretch& stretch = track.stretches[s];
    apparent_from_m_.push_back(path.apparent_m);
    if (s > 0) cross(track, s - 1, path);
    const double ratio = speed_ratio(stretch.material);
    const double length_m = stretch.to_m - stretch.from_m;
    const double end_m = path.apparent_m + length_m * ratio;
    // The last stretch includes the last sample regardless of rounding.
    const bool is_last = s + 1 == track.stretches.size();
    const int end = is_last && ratio == 1 ? samples_ : samples_before(end_m);
    append(path, stretch, end);
    if (static_cast<int>(remaining_.size()) < end) break;
    path.nepers += tissue_.nepers_per_m(stretch.material) * length_m;
    path.apparent_m = end_m;
  }
  trim();
}

void StickLosses::find_losses_at_nodes(const StickTrack& track) {
  at_node_.clear();
  double passed = 0;
  for (std::size_t s = 0; s < track.stretches.size(); ++s) {
    const Stretch& stretch = track.stretches[s];
    if (s > 0) passed += reflected_nepers(tissue_.transmission(track.interfaces[s - 1]));
    const double per_m = tissue_.nepers_per_m(stretch.material);
    const bool is_last = s + 1 == track.stretches.size();
    while (at_node_.size() < correction_.log_gain.size()) {
      const double node_m = static_cast<double>(at_node_.size()) * correction_.step_m;
      if (!is_last && node_m >= stretch.to_m) break;
      at_node_.push_back(passed + per_m * (node_m - stretch.from_m));
    }
    passed += per_m * (stretch.to_m - stretch.from_m);
  }
}

double StickLosses::share_passed(std::size_t node, double true_m, double passed) const {
  const double within = true_m / correction_.step_m - static_cast<double>(node);
  const double all = at_node_[node + 1] - at_node_[node];
  return (passed - at_node_[node] + kEvenNepers * within) / (all + kEvenNepers);
}

double StickLosses::level(const PathState& path, double true_m) const {
  const double gain = band_.log_gain(path.nepers);
  if (correction_.empty()) {
    return path.lost ? 0 : path.transmitted * std::exp(gain - path.nepers);
  }
  const double passed = path.reflected + path.nepers;
  const auto last = static_cast<int>(at_node_.size()) - 2;
  const auto node =
      static_cast<std::size_t>(std::clamp(static_cast<int>(true_m / correction_.step_m), 0, last));
  const double share = std::clamp(share_passed(node, true_m, passed), 0.0, 1.0);
  const auto near = static_cast<double>(correction_.log_gain[node]);
  const auto far = static_cast<double>(correction_.log_gain[node + 1]);
  const double narrow = std::max(-passed, -2 * kMostNepers);
  return std::exp(std::min(narrow + gain + (1 - share) * near + share * far, 0.0));
}

void StickLosses::cross(const StickTrack& track, std::size_t interface, PathState& path) {
  const Interface& crossed = track.interfaces[interface];
  at_interface_[interface] = level(path, crossed.range_m);
  const double through = tissue_.transmission(crossed);
  if (at_interface_[interface] > visible_) {
    keep_ = samples_before(path.apparent_m + kBehindInterface_m);
    if (through < kFrontTransmission) {
      fronts_.push_back({crossed.before,
                         crossed.behind,
                         samples_before(path.apparent_m),
                         keep_,
                         static_cast<float>(at_interface_[interface])});
    }
  }
  path.lost = path.lost || through < TissueLosses::kLeastTransmission;
  path.transmitted *= std::max(through, TissueLosses::kLeastTransmission);
  path.reflected += reflected_nepers(through);
}

int StickLosses::samples_before(double range_m) const {
  const double position = range_m / spacing_m_ - 0.5;
  const int whole = static_cast<int>(position);
  return std::clamp(whole < position ? whole + 1 : whole, 0, samples_);
}

void StickLosses::append(const PathState& path, const Stretch& stretch, int end) {
  const int first = static_cast<int>(remaining_.size());
  if (end <= first) return;
  const double ratio = speed_ratio(stretch.material);
  const double nepers_per_m = tissue_.nepers_per_m(stretch.material) / ratio;
  const double to_first_m = (first + 0.5) * spacing_m_ - path.apparent_m;
  const double nepers = path.nepers + nepers_per_m * to_first_m;
  const double per_sample = nepers_per_m * spacing_m_;
  const LevelLine line{path.reflected, nepers, per_sample};
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
    fill_on_axis(line, path.transmitted, first);
    if (path.lost) visible_samples_ = std::min(visible_samples_, first);
    end_where_invisible(first);
  } else {
    fill_corrected(line, stretch.from_m + to_first_m / ratio, spacing_m_ / ratio, first);
  }
  if (options_.tissue_sound_speed) append_delays(stretch, path.apparent_m);
}

void StickLosses::fill_on_axis(const LevelLine& line, double amplitude, int first) {
  const int count = static_cast<int>(remaining_.size()) - first;
  const double step = line.per_sample;
  float* values = remaining_.data() + first;
  line.for_pieces(band_, count, [&](int from, int end, const BandLoss::Piece& piece) {
    const double nepers = line.at(from), curved = piece.curvature * step * step;
    const double slope = piece.slope + 2 * piece.curvature * (nepers - piece.from);
    fill_decay(amplitude * std::exp(piece.at(nepers) - nepers),
               std::exp(step * (slope - 1) + curved),
               std::exp(2 * curved),
               end - from,
               values + from);
  });
}

void StickLosses::fill_corrected(const LevelLine& line,
                                 double true_m,
                                 double true_step_m,
                                 int first) {
  const int count = static_cast<int>(remaining_.size()) - first;
  const auto of_stretch = [&](std::vector<float>& values) {
    return std::span(values).subspan(static_cast<std::size_t>(first));
  };
  float* values = remaining_.data() + first;
  std::fill_n(values, count, 0.0f);
  add_correction(line, correction_.log_gain, true_m, true_step_m, of_stretch(remaining_));
  line.for_pieces(band_, count, [&](int begin, int end, const BandLoss::Piece& piece) {
    fill_levels(-line.reflected - line.at(begin),
                line.at(begin) - piece.from,
                line.per_sample,
                piece,
                2 * kMostNepers,
                end - begin,
                values + begin);
  });
  if (!absorbs_) return;
  const std::span<float> ratios = of_stretch(frequency_ratio_);
  add_correction(line, correction_.frequency, true_m, true_step_m, ratios);
  for (float& ratio : ratios) {
    ratio = std::clamp(ratio, static_cast<float>(BandLoss::kLowest), 1.0f);
  }
}

void StickLosses::add_correction(const LevelLine& line,
                                 std::span<const float> nodes,
                                 double true_m,
                                 double true_step_m,
                                 std::span<float> values) const {
  const int count = static_cast<int>(values.size());
  const auto last = static_cast<int>(nodes.size()) - 2;
  const double step_m = correction_.step_m;
  for (int first = 0, end = 0; first < count; first = end) {
    const double from_m = true_m + first * true_step_m;
    const int node = std::clamp(static_cast<int>(from_m / step_m), 0, last);
    const double left = std::ceil(((node + 1) * step_m - from_m) / true_step_m);
    end =
        node == last ? count : static_cast<int>(std::clamp<double>(first + left, first + 1, count));
    const auto at = static_cast<std::size_t>(node);
    const auto near = static_cast<double>(nodes[at]), far = static_cast<double>(nodes[at + 1]);
    const auto share = [&](int sample) {
      return share_passed(at, true_m + sample * true_step_m, line.reflected + line.at(sample));
    };
    const double rise = (share(end) - share(first)) / (end - first) * (far - near);
    add_ramp(near + share(first) * (far - near), rise, end - first, values.data() + first);
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
  const auto size = static_cast<int>(remaining_.size());
  visible_samples_ = std::min(visible_samples_, size);
  for (InterfaceFront& front : fronts_) front.end = std::min(front.end, size);
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
