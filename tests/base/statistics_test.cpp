// Statistics against closed forms and published values.
#include "base/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "base/units.h"

namespace wobblebench {
namespace {

/// 0, 1, … n - 1, in no order: x[i] = i.
std::vector<double> shuffled(int n) {
  std::vector<double> values;
  for (int i = 0; i < n; ++i) values.push_back(i);
  std::shuffle(values.begin(), values.end(), std::mt19937(1));
  return values;
}

TEST(Quantile, OfWholeNumbersIsItsPosition) {
  for (const int n : {1, 2, 3, 4, 10, 101}) {
    for (const double q : {0.0, 0.1, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0}) {
      EXPECT_NEAR(quantile(shuffled(n), q), q * (n - 1), 1e-12) << n << " " << q;
    }
  }
}

TEST(Quantile, IsThatOfNumpy) {
  // numpy.quantile([15, 20, 35, 40, 50], q), and numpy.median of an even number.
  const std::vector<double> values = {50, 15, 40, 20, 35};
  EXPECT_DOUBLE_EQ(quantile(values, 0.05), 16);
  EXPECT_DOUBLE_EQ(quantile(values, 0.3), 23);
  EXPECT_DOUBLE_EQ(quantile(values, 0.4), 29);
  EXPECT_DOUBLE_EQ(quantile(values, 0.95), 48);
  EXPECT_DOUBLE_EQ(quantile({40, 10, 20, 30}, 0.5), 25);
}

TEST(Quantile, OfNothingIsNan) {
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

TEST(RootMeanSquare, IsThatOfASine) {
  std::vector<double> sine;
  for (int i = 0; i < 1000; ++i) sine.push_back(3 * std::sin(2 * kPi * i / 1000));
  EXPECT_NEAR(root_mean_square(sine), 3 / std::sqrt(2.0), 1e-12);
  EXPECT_TRUE(std::isnan(root_mean_square({})));
}

TEST(Correlation, IsOneOfALineAndThatOfAnscombe) {
  // Anscombe, Am. Stat. 27, 17 (1973), the first of his four sets.
  const std::vector<double> x = {10, 8, 13, 9, 11, 14, 6, 4, 12, 7, 5};
  const std::vector<double> y = {8.04, 6.95, 7.58, 8.81, 8.33, 9.96, 7.24, 4.26, 10.84, 4.82, 5.68};
  EXPECT_NEAR(correlation(x, y), 0.81642, 1e-5);
  const std::vector<double> line = {-1, 1, 3}, steps = {1, 0, -1}, level = {2, 2, 2};
  EXPECT_NEAR(correlation(line, steps), -1, 1e-12);
  EXPECT_TRUE(std::isnan(correlation(line, level)));
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

/// 1, 2, … n, in no order.
std::vector<double> ranks(int n) {
  std::vector<double> values(static_cast<std::size_t>(n));
  std::iota(values.begin(), values.end(), 1.0);
  std::rotate(values.begin(), values.begin() + n / 3, values.end());
  return values;
}

/// Ranks and coverage of the 95 % intervals of the sign test: n = 6: 1 and 6, 96.9 %; 9: 2 and 8,
/// 96.1 %; 10: 2 and 9, 97.9 %; 15: 4 and 12, 96.5 %; 25: 8 and 18, 95.7 %.
TEST(MedianInterval, IsThatOfTheSignTest) {
  const struct {
    int n;
    double low, high, coverage;
  } table[] = {{6, 1, 6, 0.969},
               {9, 2, 8, 0.961},
               {10, 2, 9, 0.979},
               {15, 4, 12, 0.965},
               {25, 8, 18, 0.957}};
  for (const auto& row : table) {
    const MedianInterval interval = median_interval(ranks(row.n));
    EXPECT_EQ(interval.low, row.low) << row.n;
    EXPECT_EQ(interval.high, row.high) << row.n;
    EXPECT_NEAR(interval.coverage, row.coverage, 6e-4) << row.n;
  }
}

/// The true median is outside the range if all values are on one side of it: 2 * 2^-n.
TEST(MedianInterval, OfFewIsTheRangeWithWhatItCovers) {
  EXPECT_NEAR(median_interval(ranks(3)).coverage, 0.75, 1e-12);
  EXPECT_EQ(median_interval(ranks(3)).low, 1);
  EXPECT_EQ(median_interval(ranks(3)).high, 3);
  EXPECT_NEAR(median_interval(ranks(5)).coverage, 0.9375, 1e-12);
  EXPECT_NEAR(median_interval({7}).coverage, 0, 1e-12);
  EXPECT_EQ(median_interval({7}).high, 7);
}

}  // namespace
}  // namespace wobblebench
