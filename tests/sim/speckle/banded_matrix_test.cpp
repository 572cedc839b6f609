// Cholesky factors of covariances whose factors are known.
#include "sim/speckle/banded_matrix.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace wobblebench::sim {
namespace {

/// Of the product of a factor with its transpose.
double entry(const BandedMatrix& factor, int row, int lag) {
  double sum = 0;
  for (int k = 0; k + lag <= factor.band && k + lag <= row; ++k) {
    sum += factor.at(row, k + lag) * factor.at(row - lag, k);
  }
  return sum;
}

BandedMatrix covariance(int rows, int band, double (*of_lag)(int lag)) {
  BandedMatrix matrix(rows, band);
  for (int row = 0; row < rows; ++row) {
    for (int lag = 0; lag <= std::min(row, band); ++lag) matrix.at(row, lag) = of_lag(lag);
  }
  return matrix;
}

TEST(BandedMatrix, FactorOfAFirstOrderProcessIsItsRecursion) {
  // x[n] = 0.5 x[n - 1] + sqrt(0.75) e[n], x[0] = e[0]: the weight of e[n - k] is
  // 0.5^k sqrt(0.75), of e[0] 0.5^n.
  const auto factor =
      cholesky_factor(covariance(12, 11, [](int lag) { return std::pow(0.5, lag); }), 0);
  for (int row = 0; row < 12; ++row) {
    for (int lag = 0; lag <= std::min(row, factor.band); ++lag) {
      const double expected = std::pow(0.5, lag) * (lag == row ? 1 : std::sqrt(0.75));
      EXPECT_NEAR(factor.at(row, lag), expected, 2e-4) << row << " " << lag;  // small ends left out
    }
  }
  EXPECT_EQ(factor.band, 8);  // 0.5^8 = 0.0039
}

TEST(BandedMatrix, FactorOfAMovingAverageHasItsCovariance) {
  // Means of three neighbours: 1, 2/3, 1/3.
  const auto factor =
      cholesky_factor(covariance(40, 2, [](int lag) { return (3 - lag) / 3.0; }), 1e-6);
  EXPECT_EQ(factor.band, 2);
  for (int row = 2; row < 40; ++row) {
    for (int lag = 0; lag <= 2; ++lag) {
      EXPECT_NEAR(entry(factor, row, lag), (3 - lag) / 3.0, 1e-5) << row << " " << lag;
    }
  }
}

TEST(BandedMatrix, DenseLinesAreFactoredWithWhiteNoise) {
  // Neighbours are all but the same: without the noise rounding decides.
  const double noise_share = 3e-3;
  const auto factor = cholesky_factor(
      covariance(200, 80, [](int lag) { return std::exp(-0.005 * lag * lag); }), noise_share);
  for (int row = 80; row < 200; ++row) {
    EXPECT_NEAR(entry(factor, row, 0), 1, 1e-12);
    for (const int lag : {1, 5, 10, 20, 40}) {
      EXPECT_NEAR(entry(factor, row, lag), std::exp(-0.005 * lag * lag) / (1 + noise_share), 5e-3)
          << row << " " << lag;
    }
  }
}

TEST(BandedMatrix, UncorrelatedLinesKeepTheirNoise) {
  const auto factor = cholesky_factor(covariance(5, 0, [](int) { return 1.0; }), 3e-3);
  EXPECT_EQ(factor.band, 0);
  for (int row = 0; row < 5; ++row) EXPECT_EQ(factor.at(row, 0), 1);
}

}  // namespace
}  // namespace wobblebench::sim
