// Intervals of the median by order statistics, against published tables.
#include "base/median_interval.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace wobblebench {
namespace {

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
