// Statistics of the studies against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/statistics.h"
#include "bench/studies/validate/common/statistics.h"
#include "bench/studies/validate/speckle/speckle_statistics.h"
#include "sim/math/random.h"

namespace wobblebench::bench {
namespace {

/// A Rayleigh envelope of `n` samples, from the trial's number.
std::vector<double> rayleigh(std::uint64_t trial, int n) {
  std::vector<double> envelope;
  const auto key = sim::random_key(trial, sim::RandomStream::speckle, 0);
  for (int i = 0; i < n; ++i) {
    const auto z = sim::complex_normal(key, static_cast<std::uint32_t>(i));
    envelope.push_back(std::hypot(static_cast<double>(z.re), static_cast<double>(z.im)));
  }
  return envelope;
}

TEST(RayleighDistance, RejectsOneInAHundredOfTrueOnes) {
  constexpr int kTrials = 3000, kStickSamples = 400;
  int rejected = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const double distance =
        rayleigh_distance(rayleigh(static_cast<std::uint64_t>(trial) + 1, kStickSamples));
    rejected += distance > rayleigh_critical_distance(kStickSamples);
  }
  // Binomial: 30 +- 5.4.
  EXPECT_GT(rejected, 30 - 17);
  EXPECT_LT(rejected, 30 + 17);
}

TEST(RayleighDistance, RejectsWhatIsNotRayleigh) {
  std::vector<double> uniform;
  for (int i = 0; i < 400; ++i) uniform.push_back((i + 0.5) / 400);
  EXPECT_GT(rayleigh_distance(uniform), rayleigh_critical_distance(400));
  // Independent of its scale.
  auto scaled = uniform;
  for (double& value : scaled) value *= 1e3;
  EXPECT_NEAR(rayleigh_distance(scaled), rayleigh_distance(uniform), 1e-12);
}

TEST(Moments, OfAKnownList) {
  Moments moments, half;
  for (const double value : {1.0, 2.0}) moments.add(value);
  for (const double value : {3.0, 6.0}) half.add(value);
  moments.add(half);
  EXPECT_DOUBLE_EQ(moments.mean(), 3);
  EXPECT_DOUBLE_EQ(moments.sigma(), std::sqrt(3.5));
  EXPECT_DOUBLE_EQ(moments.snr(), 3 / std::sqrt(3.5));
}

TEST(FitLine, FindsTheLine) {
  const std::vector<double> x = {0, 1, 2, 5}, y = {3, 1, -1, -7};
  EXPECT_NEAR(fit_line(x, y).slope, -2, 1e-12);
  EXPECT_NEAR(fit_line(x, y).intercept, 3, 1e-12);
}

TEST(Correlation, IsThatOfPearson) {
  const std::vector<double> a = {1, 2, 3, 4}, b = {10, 20, 30, 40}, c = {4, 3, 2, 1},
                            d = {1, -1, -1, 1};
  EXPECT_NEAR(correlation(a, b), 1, 1e-12);
  EXPECT_NEAR(correlation(a, c), -1, 1e-12);
  EXPECT_NEAR(correlation(a, d), 0, 1e-12);
}

TEST(Widths, OfAGaussian) {
  std::vector<double> x, y;
  for (int i = 0; i <= 200; ++i) {
    x.push_back(0.02 * (i - 100));
    y.push_back(3 * std::exp(-0.5 * x.back() * x.back() / 0.25));
  }
  EXPECT_NEAR(full_width_at_half(x, y), 2.354820 * 0.5, 1e-3);
  EXPECT_THROW(full_width_at_half(std::span(x).first(100), std::span(y).first(100)),
               std::runtime_error);
}

TEST(GaussianPeak, IsExactBetweenSamples) {
  std::vector<double> y;
  for (int i = 0; i < 20; ++i) y.push_back(2.5 * std::exp(-0.5 * std::pow((i - 9.3) / 1.7, 2)));
  EXPECT_NEAR(gaussian_peak(y).position, 9.3, 1e-9);
  EXPECT_NEAR(gaussian_peak(y).value, 2.5, 1e-9);
  EXPECT_EQ(gaussian_peak(std::vector<double>{0, 0, 1, 0}).value, 1);
}

TEST(ScattererDensity, ClosedFormsHaveTheirLimits) {
  EXPECT_NEAR(intensity_snr(1), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(intensity_snr(1e9), 1, 1e-6);
  EXPECT_NEAR(envelope_snr(1e6), rayleigh_snr(), 1e-4);
  // The first term: 1.913 - 0.557 / N.
  EXPECT_NEAR(envelope_snr(100), rayleigh_snr() - 0.557 / 100, 1e-4);
}

TEST(EffectiveScatterers, OfAGaussianBeamAre1206TimesThoseInTheProductOfWidths) {
  // integral of exp(-4 ln 2 (x / FWHM)^2), the power's square root twice, over FWHM: sqrt(pi / 4 ln
  // 2)
  EXPECT_NEAR(effective_scatterers(10), 10 * std::pow(kPi / (4 * std::log(2.0)), 1.5), 1e-9);
}

}  // namespace
}  // namespace wobblebench::bench
