#include "sim/receive/display.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/parallel.h"
#include "sim/math/fast_math.h"

namespace wobblebench::sim {

namespace {

/// target[i] = weight * target[i] + rest * (before[i] + behind[i]).
WOBBLEBENCH_SIMD void average_lines(const float* before,
                                    const float* behind,
                                    std::size_t count,
                                    float weight,
                                    float rest,
                                    float* __restrict target) {
  for (std::size_t i = 0; i < count; ++i) {
    target[i] = weight * target[i] + rest * (before[i] + behind[i]);
  }
}

WOBBLEBENCH_SIMD void average_frames(const float* before,
                                     std::size_t count,
                                     float weight,
                                     float* __restrict target) {
  for (std::size_t i = 0; i < count; ++i) target[i] += weight * (before[i] - target[i]);
}

/// To the nearest of `steps` + 1 levels, at most 2^22, between 0 and 1.
WOBBLEBENCH_SIMD void quantise(float* samples, std::size_t count, float steps) {
  for (std::size_t i = 0; i < count; ++i) {
    const float sum = samples[i] * steps + kRoundToInteger;
    samples[i] = (sum - kRoundToInteger) / steps;
  }
}

/// As Receiver's log compression, but from one dynamic range below black to one above white.
WOBBLEBENCH_SIMD void compress(float* samples, std::size_t count, float per_octave) {
  constexpr float kSmallest = 1e-30F;
  for (std::size_t i = 0; i < count; ++i) {
    const float value =
        1.0F + per_octave * fast_log2(samples[i] < kSmallest ? kSmallest : samples[i]);
    const float above = value < -1.0F ? -1.0F : value;
    samples[i] = above > 2.0F ? 2.0F : above;
  }
}

WOBBLEBENCH_SIMD void clip(float* samples, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const float positive = samples[i] < 0.0F ? 0.0F : samples[i];
    samples[i] = positive > 1.0F ? 1.0F : positive;
  }
}

/// The outermost lines have themselves as the neighbour that is missing.
void smooth_across_lines(std::span<float> frame, std::size_t lines, float weight) {
  if (lines < 2) return;
  const std::size_t count = frame.size() / lines;
  const std::vector<float> copy(frame.begin(), frame.end());
  for (std::size_t line = 0; line < lines; ++line) {
    const std::size_t before = line == 0 ? 0 : line - 1, behind = std::min(line + 1, lines - 1);
    average_lines(copy.data() + before * count,
                  copy.data() + behind * count,
                  count,
                  1 - weight,
                  0.5F * weight,
                  frame.data() + line * count);
  }
}

bool is_log(const SimulationOptions& options) {
  return options.output == hw::SampleScale::log_compressed;
}

bool quantises(const SimulationOptions& options) {
  return options.display.grey_bits > 0 && is_log(options);
}

bool averages(const DisplayOptions& display) {
  return display.line_filter > 0 || display.persistence > 0;
}

}  // namespace

bool changes_samples(const SimulationOptions& options) {
  return averages(options.display) || quantises(options);
}

SimulationOptions before_show(const SimulationOptions& options) {
  SimulationOptions detected = options;
  if (averages(options.display)) detected.output = hw::SampleScale::linear_envelope;
  return detected;
}

void show(std::span<float> samples,
          int frames,
          const hw::AcquisitionPlan& plan,
          const SimulationOptions& options) {
  const DisplayOptions& display = options.display;
  const auto lines = static_cast<std::size_t>(plan.acquisition().sticks_per_frame);
  const std::size_t size = samples.size() / static_cast<std::size_t>(frames);
  const auto frame = [&](int i) {
    return samples.subspan(static_cast<std::size_t>(i) * size, size);
  };
  const bool compresses = averages(display) && is_log(options);
  const auto per_octave = static_cast<float>(20 * std::log10(2.0) / options.dynamic_range_db);
  parallel_ranges(frames, options.threads, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      if (compresses) compress(frame(i).data(), size, per_octave);
      if (display.line_filter > 0) {
        smooth_across_lines(frame(i), lines, static_cast<float>(display.line_filter));
      }
    }
  });
  if (display.persistence > 0) {
    for (int i = frames - 1; i > 0; --i) {
      average_frames(
          frame(i - 1).data(), size, static_cast<float>(display.persistence), frame(i).data());
    }
  }
  if (compresses) clip(samples.data(), samples.size());
  if (!quantises(options)) return;
  const auto steps = static_cast<float>((1 << display.grey_bits) - 1);
  quantise(samples.data(), samples.size(), steps);
}

}  // namespace wobblebench::sim
