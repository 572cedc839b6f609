#include "sim/clutter/haze.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>

#include "base/parallel.h"
#include "sim/losses/losses.h"
#include "sim/math/fast_math.h"
#include "sim/math/random.h"
#include "sim/math/smooth_noise.h"

namespace wobblebench::sim {

namespace {

constexpr double kStep_m = 2.5e-3;
/// Sticks within the reach of the haze that are traced.
constexpr double kSticksInReach = 3;
/// Distances over which the level varies: streaks that are longer across the sticks than along
/// them. Assumed.
constexpr double kPatch_m = 9e-3;
constexpr double kPatch_rad = 9 * kDegree;

/// iq[i] += speckle[i] * (level, linear in i).
WOBBLEBENCH_SIMD void add_scaled(
    const float* speckle, int count, float first, float step, float* __restrict iq) {
  for (int i = 0; i < count; ++i) {
    const std::ptrdiff_t at = 2 * static_cast<std::ptrdiff_t>(i);
    const float level = first + step * static_cast<float>(i);
    iq[at] += level * speckle[at];
    iq[at + 1] += level * speckle[at + 1];
  }
}

double squared(double x) {
  return x * x;
}

/// A seed of its own: haze and the speckle of tissue are independent.
std::uint64_t seed_of_haze(std::uint64_t seed) {
  return random_key(seed, RandomStream::haze, 0);
}

}  // namespace

Haze::Haze(const ScannedTissue& tissue,
           const ProbeOptics& optics,
           const SimulationOptions& options,
           double depth_m)
    : tissue_(&tissue),
      plan_(optics.plan()),
      options_(options),
      depth_m_(depth_m),
      spacing_m_(optics.iq_spacing_m()),
      speckle_(homogeneous_speckle(optics, seed_of_haze(options.seed))) {}

std::shared_ptr<const HazeVolume> Haze::volume(std::uint32_t number) const {
  return recent_.of(number, [&] { return std::make_shared<const HazeVolume>(*this, number); });
}

void Haze::add(const HazeVolume& volume,
               const hw::StickIndex& index,
               std::span<std::complex<float>> iq) const {
  const std::vector<float> levels = volume.of(index);
  const std::complex<float>* speckle = speckle_.stick(index).data();
  const int count = static_cast<int>(iq.size()), last = static_cast<int>(levels.size()) - 1;
  const double per_sample = spacing_m_ / volume.step_m();
  const int each = std::max(1, static_cast<int>(1 / per_sample));
  const auto level = [&](int sample) {
    const double at = std::clamp((sample + 0.5) * per_sample - 0.5, 0.0, static_cast<double>(last));
    const int before = std::min(static_cast<int>(at), std::max(0, last - 1));
    const auto share = static_cast<float>(at - before);
    const float near = levels[static_cast<std::size_t>(before)];
    return near + share * (levels[static_cast<std::size_t>(std::min(before + 1, last))] - near);
  };
  for (int first = 0; first < count; first += each) {
    const float near = level(first), far = level(first + each);
    add_scaled(parts_of(speckle + first),
               std::min(each, count - first),
               near,
               (far - near) / static_cast<float>(each),
               parts_of(iq.data() + first));
  }
}

HazeVolume::Axis HazeVolume::Axis::of(int all, double between_rad, double reach_rad) {
  const double span_rad = (all - 1) * between_rad;
  const int count =
      std::clamp(static_cast<int>(std::ceil(kSticksInReach * span_rad / reach_rad)) + 1, 1, all);
  return {all, count, count > 1 ? span_rad / (count - 1) : 0};
}

HazeVolume::HazeVolume(const Haze& source, std::uint32_t number)
    : number_(number),
      frames_(Axis::of(source.plan_.acquisition().frames_per_volume,
                       source.plan_.phi_step_rad(),
                       source.options_.clutter.haze_reach_rad)),
      lines_(Axis::of(source.plan_.acquisition().sticks_per_frame,
                      source.plan_.theta_step_rad(),
                      source.options_.clutter.haze_reach_rad)),
      ranges_(
          std::max(1, static_cast<int>(std::ceil(source.plan_.acquisition().depth_m / kStep_m)))),
      step_m_(source.plan_.acquisition().depth_m / ranges_) {
  const double reach_rad = source.options_.clutter.haze_reach_rad;
  const auto ranges = static_cast<std::size_t>(ranges_);
  values_.assign(
      static_cast<std::size_t>(frames_.count) * static_cast<std::size_t>(lines_.count) * ranges,
      0.0F);
  trace(source);
  spread(lines_, ranges, reach_rad);
  spread(frames_, static_cast<std::size_t>(lines_.count) * ranges, reach_rad);
  trail(source.options_.clutter.haze_trail_m);
  set_level(source);
}

void HazeVolume::trace(const Haze& source) {
  const auto ranges = static_cast<std::size_t>(ranges_);
  const hw::ProbeGeometry geometry = source.plan_.geometry();
  parallel_ranges(frames_.count * lines_.count, source.options_.threads, [&](int first, int last) {
    StickTrack track;
    StickLosses losses(source.plan_,
                       source.options_,
                       source.tissue_->materials,
                       source.spacing_m_,
                       source.speckle_.samples);
    for (int i = first; i < last; ++i) {
      const hw::StickIndex index{
          number_,
          static_cast<std::uint32_t>(std::lround(frames_.place(i / lines_.count))),
          static_cast<std::uint32_t>(std::lround(lines_.place(i % lines_.count)))};
      follow(*source.tissue_,
             stick_ray(source.plan_, geometry, index),
             source.depth_m_,
             track,
             Surfaces::crossed);
      losses.compute(track);
      add_echoes(track,
                 losses,
                 source,
                 std::span(values_).subspan(static_cast<std::size_t>(i) * ranges, ranges));
    }
  });
}

/// Mean power of tissue at the middle of each step of range. Interfaces are left out.
void HazeVolume::add_echoes(const StickTrack& track,
                            const StickLosses& losses,
                            const Haze& source,
                            std::span<float> power) const {
  const auto& materials = source.tissue_->materials;
  const auto material = [&](phantoms::MaterialIndex index) -> const phantoms::Material& {
    return materials[static_cast<std::size_t>(index)];
  };
  const auto& left = losses.remaining();
  for (const Stretch& stretch : track.stretches) {
    const double echo_db = material(stretch.material).backscatter_db;
    if (echo_db <= kZeroAmplitude_db) continue;
    const double echo = kPowerOfRayleighMean * squared(amplitude_of_db(echo_db));
    const double from = losses.apparent_m(track, stretch.from_m) / step_m_ - 0.5;
    const double to = losses.apparent_m(track, stretch.to_m) / step_m_ - 0.5;
    const bool is_last = &stretch == &track.stretches.back();
    for (int i = std::max(0, static_cast<int>(std::ceil(from))); i < ranges_ && (is_last || i < to);
         ++i) {
      const auto sample = static_cast<std::size_t>((i + 0.5) * step_m_ / source.spacing_m_);
      if (sample >= left.size()) return;
      power[static_cast<std::size_t>(i)] =
          static_cast<float>(echo * squared(static_cast<double>(left[sample])));
    }
  }
}

/// The mean over sticks, weighted with exp(-angle / reach). `stride`: between neighbours.
void HazeVolume::spread(const Axis& axis, std::size_t stride, double reach_rad) {
  if (axis.count == 1) return;
  const auto count = static_cast<std::size_t>(axis.count), block = count * stride;
  std::vector<double> weight;
  for (int i = 0; i < axis.count; ++i) weight.push_back(std::exp(-i * axis.step_rad / reach_rad));
  std::vector<double> mean(block);
  for (std::size_t base = 0; base < values_.size(); base += block) {
    std::fill(mean.begin(), mean.end(), 0.0);
    for (std::size_t to = 0; to < count; ++to) {
      double total = 0;
      for (std::size_t from = 0; from < count; ++from)
        total += weight[to > from ? to - from : from - to];
      for (std::size_t from = 0; from < count; ++from) {
        const double share = weight[to > from ? to - from : from - to] / total;
        for (std::size_t k = 0; k < stride; ++k) {
          mean[to * stride + k] += share * static_cast<double>(values_[base + from * stride + k]);
        }
      }
    }
    std::transform(mean.begin(),
                   mean.end(),
                   values_.begin() + static_cast<std::ptrdiff_t>(base),
                   [](double value) { return static_cast<float>(value); });
  }
}

void HazeVolume::trail(double length_m) {
  const double keep = std::exp(-step_m_ / length_m), keep_half = std::sqrt(keep);
  const auto ranges = static_cast<std::size_t>(ranges_);
  for (std::size_t base = 0; base < values_.size(); base += ranges) {
    double tail = 0;
    for (std::size_t k = base; k < base + ranges; ++k) {
      const auto power = static_cast<double>(values_[k]);
      values_[k] = static_cast<float>(power + keep_half * (tail - power));  // in its middle
      tail = power + keep * (tail - power);
    }
  }
}

void HazeVolume::set_level(const Haze& source) {
  const ClutterOptions& clutter = source.options_.clutter;
  const std::uint64_t key = random_key(source.options_.seed, RandomStream::haze, 1);
  const double highest = amplitude_of_db(clutter.haze_db);
  std::size_t at = 0;
  for (int frame = 0; frame < frames_.count; ++frame) {
    for (int line = 0; line < lines_.count; ++line) {
      for (int i = 0; i < ranges_; ++i, ++at) {
        const double range_m = (i + 0.5) * step_m_;
        const double fall = amplitude_of_db(-clutter.haze_fall_db_per_cm * range_m / 1e-2);
        const float normal = smooth_noise(key,
                                          {frame * frames_.step_rad / kPatch_rad,
                                           line * lines_.step_rad / kPatch_rad,
                                           range_m / kPatch_m});
        values_[at] = std::sqrt(values_[at]) * static_cast<float>(highest * fall) *
                      level_factor(clutter.haze_unevenness_db, normal);
      }
    }
  }
}

std::vector<float> HazeVolume::of(const hw::StickIndex& index) const {
  struct Between {
    std::size_t near;
    std::size_t far;
    float share;
  };
  const auto between = [](const Axis& axis, std::uint32_t i) -> Between {
    if (axis.count == 1) return {0, 0, 0};
    const double at = i * (axis.count - 1.0) / (axis.all - 1);
    const auto near =
        std::min(static_cast<std::size_t>(at), static_cast<std::size_t>(axis.count) - 2);
    return {near, near + 1, static_cast<float>(at - static_cast<double>(near))};
  };
  const Between frame = between(frames_, index.frame), line = between(lines_, index.line);
  const auto ranges = static_cast<std::size_t>(ranges_);
  std::vector<float> levels(ranges, 0.0F);
  const auto add = [&](std::size_t of_frame, std::size_t of_line, float weight) {
    const float* from =
        values_.data() + (of_frame * static_cast<std::size_t>(lines_.count) + of_line) * ranges;
    for (std::size_t i = 0; i < ranges; ++i) levels[i] += weight * from[i];
  };
  add(frame.near, line.near, (1 - frame.share) * (1 - line.share));
  add(frame.near, line.far, (1 - frame.share) * line.share);
  add(frame.far, line.near, frame.share * (1 - line.share));
  add(frame.far, line.far, frame.share * line.share);
  return levels;
}

}  // namespace wobblebench::sim
