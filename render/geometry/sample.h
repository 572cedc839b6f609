// What a sample of a stick may be, for the GL passes and the double-precision reference.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "hw/probe/polar_volume.h"

namespace wobblebench::render {

/// A sample clamped to [0, 1], 0 for NaN and infinities, so that a bad sample affects its
/// neighbourhood only.
inline float clean_sample(float sample) {
  // On the bit patterns, which order as the positive floats do, so that the loop is vectorised:
  // negative values, infinity and NaN lie above the largest finite float.
  const auto bits = std::bit_cast<std::uint32_t>(sample);
  const bool is_valid = bits <= std::bit_cast<std::uint32_t>(std::numeric_limits<float>::max());
  return std::bit_cast<float>(is_valid ? std::min(bits, std::bit_cast<std::uint32_t>(1.0f)) : 0u);
}

/// Throws std::invalid_argument for linear envelopes: thresholds and transfer function are those of
/// log-compressed samples.
inline void check_log_compressed(const hw::PolarVolume& volume) {
  if (volume.scale() == hw::SampleScale::log_compressed) return;
  throw std::invalid_argument(
      "the samples of the volume are linear envelopes; only log-compressed ones can be rendered");
}

}  // namespace wobblebench::render
