// Correlations and widths of speckle whose answers are known.
#include "bench/studies/validate/speckle/speckle_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <stdexcept>

#include "base/units.h"
#include "sim/math/random.h"

namespace wobblebench::bench {
namespace {

constexpr int kSamples = 400, kFrames = 50;

std::complex<double> noise(int line, int frame, int sample) {
  const auto key = sim::random_key(1, sim::RandomStream::speckle, static_cast<std::uint64_t>(line));
  const auto z = sim::complex_normal(key, static_cast<std::uint32_t>(frame * kSamples + sample));
  return {static_cast<double>(z.re), static_cast<double>(z.im)};
}

/// Two lines of white noise whose fields correlate by `rho`; samples 1 mm apart.
SpeckleGrid pair_of_lines(double rho) {
  SpeckleGrid grid{{-1 * kDegree, 1 * kDegree}, kFrames, kSamples, 1e-3, {}};
  for (int f = 0; f < kFrames; ++f) {
    for (int l = 0; l < 2; ++l) {
      for (int k = 0; k < kSamples; ++k) {
        const auto first = noise(0, f, k);
        const auto z = l == 0 ? first : rho * first + std::sqrt(1 - rho * rho) * noise(1, f, k);
        // The level of a line must not matter.
        grid.values.push_back(static_cast<float>((l == 0 ? 1 : 3) * std::abs(z)));
      }
    }
  }
  return grid;
}

TEST(IntensityCorrelation, IsTheSquareOfTheFields) {
  for (const double rho : {0.0, 0.5, 0.8, 1.0}) {
    const double found = intensity_correlation(pair_of_lines(rho), {0, 1}, {0, 1, 0});
    EXPECT_NEAR(found, rho * rho, 0.03) << rho;
  }
}

TEST(IntensityCorrelation, OfWhiteNoiseIsNoneAtAnyStep) {
  const SpeckleGrid grid = pair_of_lines(1);
  EXPECT_NEAR(intensity_correlation(grid, {0, 1}, {1, 0, 0}), 0, 0.03);
  EXPECT_NEAR(intensity_correlation(grid, {0, 1}, {0, 0, 1}), 0, 0.03);
  EXPECT_NEAR(intensity_correlation(grid, {0, 1}, {0, 0, 0}), 1, 1e-12);
  EXPECT_TRUE(std::isnan(intensity_correlation(grid, {0, 1}, {0, 2, 0}))) << "no pair";
}

TEST(MeanIntensity, IsOfTheMiddleLineAndTheWindow) {
  SpeckleGrid grid{{-1 * kDegree, 0, 1 * kDegree}, 1, 4, 1e-3, {}};
  grid.values = {9, 9, 9, 9, 5, 1, 3, 5, 9, 9, 9, 9};
  EXPECT_DOUBLE_EQ(mean_intensity(grid, {1e-3, 3e-3}), 0.5 * (1 + 9));
}

TEST(AutocovarianceFwhm, OfAGaussianIsExactAtAnyStep) {
  for (const double step_m : {0.1e-3, 0.4e-3, 1.3e-3}) {
    std::vector<double> values;
    for (int i = 1; i < 40; ++i) values.push_back(std::exp2(-std::pow(i * step_m / 0.9e-3, 2)));
    EXPECT_NEAR(autocovariance_fwhm_m(values, step_m), 1.8e-3, 1e-9) << step_m;
  }
  EXPECT_THROW(autocovariance_fwhm_m({0.9, 0.8}, 1e-3), std::runtime_error);
}

}  // namespace
}  // namespace wobblebench::bench
