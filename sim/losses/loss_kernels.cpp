#include "sim/losses/loss_kernels.h"

#include <algorithm>
#include <cmath>

#include "sim/math/fast_math.h"
#include "sim/math/simd.h"

namespace wobblebench::sim {

/// Eight values at a time: the ratio of values eight apart changes by change^64 a step.
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

WOBBLEBENCH_SIMD void fill_ramp(
    double from, double per_sample, double least, int count, float* __restrict values) {
  for (int i = 0; i < count; ++i) {
    const double value = from + i * per_sample;
    values[i] = static_cast<float>(value < least ? least : value);
  }
}

namespace {

/// values[i] += from + i * per_sample.
WOBBLEBENCH_SIMD void add_ramp(double from,
                               double per_sample,
                               int count,
                               float* __restrict values) {
  for (int i = 0; i < count; ++i) values[i] += static_cast<float>(from + i * per_sample);
}

}  // namespace

void add_interpolated(
    std::span<const float> nodes, double from, double per_sample, int count, float* values) {
  const int intervals = static_cast<int>(nodes.size()) - 1;
  for (int first = 0, node = 0; first < count; ++node) {
    const bool is_last = node >= intervals;
    const double samples = std::ceil((node + 1 - from) / per_sample);
    const int end = is_last ? count : static_cast<int>(std::clamp<double>(samples, first, count));
    const auto near =
        static_cast<double>(nodes[static_cast<std::size_t>(std::min(node, intervals))]);
    const double rise =
        is_last ? 0 : static_cast<double>(nodes[static_cast<std::size_t>(node) + 1]) - near;
    const double at = from + first * per_sample - node;
    add_ramp(near + at * rise, rise * per_sample, end - first, values + first);
    first = end;
  }
}

WOBBLEBENCH_SIMD void fill_levels(const LevelLine& line,
                                  double variance,
                                  double most_nepers,
                                  double most_narrow,
                                  int count,
                                  float* __restrict values) {
  constexpr float kLowest = -80;  // 1e-35 is a normal number
  const double transmitted = line.log_transmitted, from = line.nepers, step = line.per_sample;
  for (int i = 0; i < count; ++i) {
    const double nepers = from + i * step;
    const double within = nepers < most_nepers ? nepers : most_nepers;
    const double narrow = transmitted - nepers;
    const double bounded = narrow < -most_narrow ? -most_narrow : narrow;
    const double level = bounded + variance * within * (nepers - 0.5 * within);
    const float log_level = static_cast<float>(level) + values[i];
    const float least = log_level < kLowest ? kLowest : log_level;
    values[i] = fast_exp(least > 0.0f ? 0.0f : least);
  }
}

}  // namespace wobblebench::sim
