// The covariance of an edge against a sum over scatterers, its derivative against differences, and
// the Fisher information against closed forms and the log likelihood of drawn samples.
#include "bench/evaluation/bound/edge_signal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "base/units.h"
#include "tests/bench/evaluation/bound/bound_samples.h"
#include "tests/bench/evaluation/bound/oracle.h"

namespace wobblebench::bench {
namespace {

constexpr double kPulse_m = 0.137e-3;
constexpr double kFirst_m = -0.9e-3;
constexpr double kEdge_m = 0.05e-3;
constexpr int kSamples = 14;

/// The integral over ranges u of tissue power(u) h(a - u) h(b - u), h of unit energy.
double echo_covariance(double a_m, double b_m, double footprint_m) {
  const double step_m = 2e-6;
  const double peak2 = 1 / (std::sqrt(kPi) * kPulse_m);
  double sum = 0;
  for (double u = -4e-3; u < 4e-3; u += step_m) {
    const double tissue = 0.5 * std::erfc(-(u - kEdge_m) / (std::sqrt(2.0) * footprint_m));
    const double a = (a_m - u) / kPulse_m, b = (b_m - u) / kPulse_m;
    sum += tissue * peak2 * std::exp(-0.5 * (a * a + b * b)) * step_m;
  }
  return sum;
}

TEST(EdgeSignal, CovarianceIsTheSumOverScatterersBehindTheSurface) {
  constexpr double kFootprint_m = 0.3e-3;
  const EdgeSignal signal = test_signal(40, kFootprint_m);
  const auto covariance = edge_covariance(signal, kEdge_m, kFirst_m, kSamples);
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) {
      const double expected =
          echo_covariance(
              kFirst_m + i * signal.spacing_m, kFirst_m + j * signal.spacing_m, kFootprint_m) +
          (i == j ? 1e-4 : 0);
      EXPECT_NEAR(covariance.value.at(i, j).real(), expected, 1e-5) << i << " " << j;
    }
  }
}

TEST(EdgeSignal, FieldMultipliesSpeckleByTheRootOfTheMeanPower) {
  const EdgeSignal signal = test_signal(40, 0.2e-3, &edge_after_pulse);
  const auto covariance = edge_covariance(signal, kEdge_m, kFirst_m, kSamples);
  const auto power = [&](int i) { return covariance.value.at(i, i).real(); };
  const EdgeRise rise = gaussian_rise(std::hypot(0.2e-3, kPulse_m / std::sqrt(2.0)));
  for (int i = 0; i + 1 < kSamples; ++i) {
    EXPECT_NEAR(covariance.value.at(i, i + 1).real(),
                std::exp(-std::pow(0.156 / (2 * 0.137), 2)) *
                    std::sqrt((power(i) - 1e-4) * (power(i + 1) - 1e-4)),
                1e-12);
    EXPECT_NEAR(power(i), rise(kFirst_m + i * signal.spacing_m - kEdge_m).share + 1e-4, 1e-12);
  }
}

TEST(EdgeSignal, DerivativeIsThatOfTheCovarianceByTheSurfacesPlace) {
  constexpr double kStep_m = 1e-8;
  for (const auto order : {&pulse_after_edge, &edge_after_pulse}) {
    EdgeSignal signal = test_signal(40, 0.2e-3, order);
    signal.fluid_power = 0.01;
    const auto at = edge_covariance(signal, kEdge_m, kFirst_m, kSamples);
    const auto low = edge_covariance(signal, kEdge_m - kStep_m, kFirst_m, kSamples);
    const auto high = edge_covariance(signal, kEdge_m + kStep_m, kFirst_m, kSamples);
    for (std::size_t i = 0; i < at.value.values.size(); ++i) {
      const std::complex<double> difference =
          (high.value.values[i] - low.value.values[i]) / (2 * kStep_m);
      EXPECT_LT(std::abs(at.derivative.values[i] - difference),
                1e-3);  // of 1/m, where it reaches 1800
    }
  }
}

SquareMatrix diagonal(const std::vector<double>& values) {
  SquareMatrix matrix(static_cast<int>(values.size()));
  for (int i = 0; i < matrix.size; ++i) matrix.at(i, i) = values[static_cast<std::size_t>(i)];
  return matrix;
}

TEST(GaussianInformation, IndependentSamplesAddTheSquaresOfTheirLogDerivatives) {
  const std::vector<double> variance{1, 4, 0.5}, derivative{2, 1, -3};
  const double expected = 4 + 1.0 / 16 + 36;
  EXPECT_NEAR(covariance_information(diagonal(variance), diagonal(derivative)), expected, 1e-12);
  EXPECT_NEAR(independent_information(variance, derivative), expected, 1e-12);
}

// R = s [1 r; r 1]. Of s: 2 / s^2, whatever r is. Of r: 2 (1 + r^2) / (1 - r^2)^2.
TEST(GaussianInformation, OfTwoCorrelatedSamples) {
  constexpr double kScale = 3, kCorrelation = 0.7;
  SquareMatrix covariance(2), by_scale(2), by_correlation(2);
  for (int i = 0; i < 2; ++i) {
    covariance.at(i, i) = kScale;
    by_scale.at(i, i) = 1;
    covariance.at(i, 1 - i) = kScale * kCorrelation;
    by_scale.at(i, 1 - i) = kCorrelation;
    by_correlation.at(i, 1 - i) = kScale;
  }
  EXPECT_NEAR(covariance_information(covariance, by_scale), 2 / (kScale * kScale), 1e-12);
  const double r2 = kCorrelation * kCorrelation;
  EXPECT_NEAR(covariance_information(covariance, by_correlation),
              2 * (1 + r2) / ((1 - r2) * (1 - r2)),
              1e-9);
}

TEST(GaussianInformation, RefusesWhatIsNoCovariance) {
  const SquareMatrix negative = diagonal({1, -1});
  EXPECT_THROW(covariance_information(negative, negative), std::domain_error);
}

// The information is the variance of the score, and the score is the slope of the log likelihood.
TEST(GaussianInformation, IsTheVarianceOfTheNumericalScore) {
  const EdgeSignal signal = test_signal(30);
  constexpr double kLow_m = -1e-3, kAt_m = 0.04e-3, kStep_m = 1e-6;
  constexpr int kCount = 12, kDraws = 4000;
  const auto at = edge_covariance(signal, kAt_m, kLow_m, kCount);
  const auto sticks = drawn_sticks(at.value, kDraws, 7);
  const auto low = edge_covariance(signal, kAt_m - kStep_m, kLow_m, kCount);
  const auto high = edge_covariance(signal, kAt_m + kStep_m, kLow_m, kCount);
  double sum = 0, squares = 0;
  for (const IqSamples& stick : sticks) {
    const double score =
        (log_likelihood(high.value, stick) - log_likelihood(low.value, stick)) / (2 * kStep_m);
    sum += score / kDraws;
    squares += score * score / kDraws;
  }
  const double information = covariance_information(at.value, at.derivative);
  // Of 4000 squares of near-Gaussian scores the mean is known to 2.2 %, of their mean to 1.6 % of
  // the root.
  EXPECT_NEAR(squares / information, 1, 0.1);
  EXPECT_LT(std::abs(sum), 4 * std::sqrt(information / kDraws));
}

}  // namespace
}  // namespace wobblebench::bench
