// Counter-based random numbers: pure functions of seed, stream and index, so that any thread gets
// the same number in any order and in any run. No state.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/hash.h"
#include "sim/math/fast_math.h"

namespace wobblebench::sim {

/// Purpose of random numbers; each purpose has its own stream.
enum class RandomStream : std::uint64_t {
  speckle = 1,
  noise = 2,
  scatterers = 3,
  uneven_tissue = 4,
  haze = 5,
  particles = 6
};

/// Key of one sequence of numbers, whose elements are uniform_bits(key, i).
constexpr std::uint64_t random_key(std::uint64_t seed,
                                   RandomStream stream,
                                   std::uint64_t a,
                                   std::uint64_t b = 0) {
  std::uint64_t key = mix64(seed + kGoldenGamma);
  key = mix64(key ^ (static_cast<std::uint64_t>(stream) * kGoldenGamma));
  key = mix64(key ^ (a + kGoldenGamma));
  return mix64(key ^ (b + kGoldenGamma));
}

constexpr std::uint64_t uniform_bits(std::uint64_t key, std::uint64_t index) {
  return mix64(key + (index + 1) * kGoldenGamma);
}

/// Hash of 32 bits, a bijection, for vectorised loops (Wellons, "lowbias32").
WOBBLEBENCH_INLINE std::uint32_t mix32(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352dU;
  x = (x ^ (x >> 15)) * 0x846ca68bU;
  return x ^ (x >> 16);
}

struct ComplexNormal {
  float re;
  float im;
};

/// Largest magnitude that complex_normal() returns: its uniform number has 25 bits.
inline constexpr float kMaxComplexNormal = 4.17f;

/// Circular complex normal number of unit mean power (Box-Muller transform of two hashes).
WOBBLEBENCH_INLINE ComplexNormal complex_normal(std::uint64_t key, std::uint32_t index) {
  const std::uint32_t first = mix32(index * 0x9e3779b9U + static_cast<std::uint32_t>(key));
  const std::uint32_t second = mix32(first + static_cast<std::uint32_t>(key >> 32));
  constexpr float kScale = 1.0f / 16777216.0f;
  const float u = (static_cast<float>(static_cast<std::int32_t>(first >> 8)) + 0.5f) * kScale;
  const CosSin direction =
      cos_sin_of_cycles(static_cast<float>(static_cast<std::int32_t>(second >> 8)) * kScale);
  // -ln u; rounding can make u 1, whose logarithm is 0.
  const float power = fast_log2(u) * -0.693147181f;
  const float radius = std::sqrt(power < 0.0f ? 0.0f : power);
  return {radius * direction.cosine, radius * direction.sine};
}

}  // namespace wobblebench::sim
