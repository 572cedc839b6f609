// Quantiles against their closed forms.
#include "base/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace wobblebench {
namespace {

/// 0, 1, … n - 1, in no order: x[i] = i.
std::vector<double> shuffled(int n) {
  std::vector<double> values;
  for (int i = 0; i < n; ++i) values.push_back(i);
  std::shuffle(values.begin(), values.end(), std::mt19937(1));
  return values;
}

TEST(Quantile, FollowsItsDefinition) {
  for (const int n : {1, 2, 3, 4, 10, 101}) {
    const auto values = shuffled(n);
    for (const double q : {0.0, 0.1, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0}) {
      const double position = q * (n - 1);
      EXPECT_NEAR(quantile_linear(values, q), position, 1e-12) << n << " " << q;
      EXPECT_EQ(quantile_nearest(values, q), std::round(position)) << n << " " << q;
      EXPECT_EQ(quantile_lower(values, q), std::floor(position)) << n << " " << q;
      EXPECT_EQ(quantile_upper(values, q), std::min(std::floor(q * n), n - 1.0)) << n << " " << q;
    }
  }
}

TEST(Quantile, DefinitionsDifferForFewValues) {
  const std::vector<double> values = {40, 10, 20, 30};
  EXPECT_DOUBLE_EQ(quantile_linear(values, 0.6), 28);
  EXPECT_EQ(quantile_nearest(values, 0.6), 30);
  EXPECT_EQ(quantile_lower(values, 0.6), 20);
  EXPECT_EQ(quantile_upper(values, 0.6), 30);
  EXPECT_EQ(quantile_nearest(values, 0.5), 30) << "halfway: the upper one";
  EXPECT_EQ(quantile_upper(values, 0.25), 20) << "more than a quarter is not above it";
}

TEST(Quantile, OfNothingIsNan) {
  EXPECT_TRUE(std::isnan(quantile_linear({}, 0.5)));
  EXPECT_TRUE(std::isnan(quantile_nearest({}, 0.5)));
  EXPECT_TRUE(std::isnan(quantile_lower({}, 0.5)));
  EXPECT_TRUE(std::isnan(quantile_upper({}, 0.5)));
}

TEST(Spread, IsMedianAndRange) {
  const Spread odd = spread_of({3, 1, 7});
  EXPECT_EQ(odd.median, 3);
  EXPECT_EQ(odd.min, 1);
  EXPECT_EQ(odd.max, 7);
  EXPECT_EQ(spread_of({4, 1, 2, 9}).median, 3);
  EXPECT_EQ(spread_of({5}).median, 5);
}

TEST(Quartiles, AreLinearBetweenNeighbours) {
  const Quartiles quartiles = quartiles_of({1, 2, 3, 4});
  EXPECT_DOUBLE_EQ(quartiles.lower, 1.75);
  EXPECT_DOUBLE_EQ(quartiles.median, 2.5);
  EXPECT_DOUBLE_EQ(quartiles.upper, 3.25);
}

TEST(PairedRatio, CancelsADriftOfBoth) {
  // Both slow down by 2, then by 5; the second repeat of the values was disturbed besides.
  const Quartiles ratio = paired_ratio({3, 8, 15, 3}, {2, 4, 10, 2});
  EXPECT_DOUBLE_EQ(ratio.median, 1.5);
  EXPECT_DOUBLE_EQ(ratio.lower, 1.5);
  EXPECT_DOUBLE_EQ(ratio.upper, 1.625);
}

}  // namespace
}  // namespace wobblebench
