#include "sim/math/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <set>

namespace wobblebench::sim {
namespace {

std::complex<double> normal(std::uint64_t key, std::uint32_t index) {
  const ComplexNormal z = complex_normal(key, index);
  return {static_cast<double>(z.re), static_cast<double>(z.im)};
}

TEST(Random, ComplexNormalHasUnitPowerAndNoMean) {
  constexpr int kCount = 200000;
  const auto key = random_key(1, RandomStream::speckle, 2, 3);
  std::complex<double> mean = 0, pseudo_power = 0;
  double power = 0, fourth = 0;
  for (int i = 0; i < kCount; ++i) {
    const auto z = normal(key, static_cast<std::uint32_t>(i));
    mean += z;
    pseudo_power += z * z;
    power += std::norm(z);
    fourth += std::norm(z) * std::norm(z);
  }
  // Five standard errors of each estimate.
  const double tolerance = 5 / std::sqrt(kCount);
  EXPECT_LT(std::abs(mean) / kCount, tolerance);
  EXPECT_LT(std::abs(pseudo_power) / kCount, 2 * tolerance) << "not circular";
  EXPECT_NEAR(power / kCount, 1, tolerance);
  EXPECT_NEAR(fourth / kCount, 2, 5 * tolerance) << "intensity is not exponential";
}

TEST(Random, IsAFunctionOfItsArgumentsAlone) {
  const auto key = random_key(7, RandomStream::noise, 1, 2);
  EXPECT_EQ(key, random_key(7, RandomStream::noise, 1, 2));
  EXPECT_EQ(normal(key, 5), normal(key, 5));
}

TEST(Random, EveryArgumentMatters) {
  std::set<std::uint64_t> keys;
  int made = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    for (auto stream : {RandomStream::speckle, RandomStream::noise}) {
      for (std::uint64_t a = 0; a < 40; ++a) {
        for (std::uint64_t b = 0; b < 40; ++b, ++made) keys.insert(random_key(seed, stream, a, b));
      }
    }
  }
  EXPECT_EQ(keys.size(), static_cast<std::size_t>(made));
}

TEST(Random, NeighbouringSequencesAreUncorrelated) {
  constexpr int kCount = 100000;
  const auto a = random_key(1, RandomStream::speckle, 10, 20);
  const auto b = random_key(1, RandomStream::speckle, 10, 21);
  std::complex<double> cross = 0, shifted = 0;
  for (int i = 0; i < kCount; ++i) {
    const auto n = static_cast<std::uint32_t>(i);
    const std::complex<double> za = normal(a, n);
    cross += za * std::conj(normal(b, n));
    shifted += za * std::conj(normal(a, n + 1));
  }
  EXPECT_LT(std::abs(cross) / kCount, 5 / std::sqrt(kCount));
  EXPECT_LT(std::abs(shifted) / kCount, 5 / std::sqrt(kCount));
}

}  // namespace
}  // namespace wobblebench::sim
