// Randomness as a function: the same seed, stream and index give the same number on any thread, in
// any order, on any run. Nothing here holds state.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>

#include "hw/units.h"

namespace wobblebench::sim {

/// What a random number is for; keeps the streams of different effects apart.
enum class RandomStream : std::uint64_t { speckle = 1, noise = 2 };

/// The finaliser of SplitMix64 (Steele, Lea and Flood, OOPSLA 2014): a bijection that passes
/// BigCrush when fed a counter.
constexpr std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

inline constexpr std::uint64_t kGoldenGamma = 0x9e3779b97f4a7c15ULL;

/// Key of one sequence of numbers; index it with uniform_bits(key, i).
constexpr std::uint64_t random_key(std::uint64_t seed,
                                   RandomStream stream,
                                   std::uint64_t a,
                                   std::uint64_t b = 0) {
  std::uint64_t key = mix(seed + kGoldenGamma);
  key = mix(key ^ (static_cast<std::uint64_t>(stream) * kGoldenGamma));
  key = mix(key ^ (a + kGoldenGamma));
  return mix(key ^ (b + kGoldenGamma));
}

constexpr std::uint64_t uniform_bits(std::uint64_t key, std::uint64_t index) {
  return mix(key + (index + 1) * kGoldenGamma);
}

/// Circular complex normal of unit mean power (Box-Muller on the two halves of one hash).
inline std::complex<float> complex_normal(std::uint64_t key, std::uint64_t index) {
  const std::uint64_t bits = uniform_bits(key, index);
  constexpr float kScale = 1.0f / 4294967296.0f;
  const float u = (static_cast<float>(bits >> 32) + 0.5f) * kScale;
  const float angle =
      static_cast<float>(2 * kPi) * static_cast<float>(bits & 0xffffffffULL) * kScale;
  // Rounding can lift u to just above 1, where the logarithm changes sign.
  const float radius = std::sqrt(std::max(0.0f, -std::log(u)));
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace wobblebench::sim
