// The hash that random numbers are made of.
#pragma once

#include <cstdint>

namespace wobblebench {

/// The finaliser of SplitMix64 (Steele, Lea and Flood, OOPSLA 2014): a bijection that passes
/// BigCrush when fed a counter.
constexpr std::uint64_t mix64(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// SplitMix64's increment: mix64(seed + (i + 1) * kGoldenGamma) is its i-th number.
inline constexpr std::uint64_t kGoldenGamma = 0x9e3779b97f4a7c15ULL;

/// Uniform in [0, 1), of the upper 53 bits.
constexpr double unit_interval(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

}  // namespace wobblebench
