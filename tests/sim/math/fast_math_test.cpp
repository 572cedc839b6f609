#include "sim/math/fast_math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace wobblebench::sim {
namespace {

TEST(FastMath, Log2OverAllNormalNumbers) {
  double worst = 0;
  for (double x = 1.2e-38; x < 3e38; x *= 1.00137) {
    const auto value = static_cast<float>(x);
    const double expected = std::log2(static_cast<double>(value));
    const double error = std::abs(static_cast<double>(fast_log2(value)) - expected);
    worst = std::max(worst, error / std::max(1.0, std::abs(expected)));
  }
  EXPECT_LT(worst, 3e-7);
}

TEST(FastMath, Log2IsZeroAtOneAndRisesAroundIt) {
  EXPECT_EQ(fast_log2(1.0f), 0.0f);
  EXPECT_LT(fast_log2(std::nextafter(1.0f, 0.0f)), 0.0f);
  EXPECT_GT(fast_log2(std::nextafter(1.0f, 2.0f)), 0.0f);
}

TEST(FastMath, Exp) {
  double worst = 0;
  for (double x = -86.9; x < 88; x += 0.00731) {
    const auto value = static_cast<float>(x);
    const double expected = std::exp(static_cast<double>(value));
    worst = std::max(worst, std::abs(static_cast<double>(fast_exp(value)) / expected - 1));
  }
  EXPECT_LT(worst, 3e-7);
  EXPECT_EQ(fast_exp(-200.0f), 0.0f);
  EXPECT_EQ(fast_exp(0.0f), 1.0f);
}

TEST(FastMath, CosineAndSineOfCycles) {
  double worst = 0;
  for (double u = -8; u <= 8; u += 0.000173) {
    const auto value = static_cast<float>(u);
    const double angle = 2 * std::numbers::pi * static_cast<double>(value);
    const CosSin found = cos_sin_of_cycles(value);
    worst = std::max(worst, std::abs(static_cast<double>(found.cosine) - std::cos(angle)));
    worst = std::max(worst, std::abs(static_cast<double>(found.sine) - std::sin(angle)));
  }
  EXPECT_LT(worst, 4e-7);
}

TEST(FastMath, GaussianAndItsDistribution) {
  for (double u = -6; u <= 6; u += 0.0137) {
    const Gaussian found = gaussian(static_cast<float>(u));
    EXPECT_NEAR(found.density, std::exp(-u * u / 2), 1e-6);
    EXPECT_NEAR(found.distribution, 0.5 * std::erfc(-u / std::numbers::sqrt2), 5e-7);
  }
}

}  // namespace
}  // namespace wobblebench::sim
