// Fisher information against closed forms, and against the log likelihood of drawn samples.
#include "bench/evaluation/bound/gaussian_information.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "tests/bench/evaluation/bound/oracle.h"
#include "tests/bench/evaluation/bound/bound_samples.h"

namespace wobblebench::bench {
namespace {

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
  constexpr double kFirst_m = -1e-3, kEdge_m = 0.04e-3, kStep_m = 1e-6;
  constexpr int kSamples = 12, kDraws = 4000;
  const auto at = edge_covariance(signal, kEdge_m, kFirst_m, kSamples);
  const auto sticks = drawn_sticks(at.value, kDraws, 7);
  const auto low = edge_covariance(signal, kEdge_m - kStep_m, kFirst_m, kSamples);
  const auto high = edge_covariance(signal, kEdge_m + kStep_m, kFirst_m, kSamples);
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
