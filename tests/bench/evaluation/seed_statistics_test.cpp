// Intervals against printed tables of Student's t.
#include "bench/evaluation/seed_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace wobblebench::bench {
namespace {

TEST(MeanInterval, IsStudentsOfKnownNumbers) {
  // t(0.975) with 4 degrees of freedom: 2.776; standard deviation sqrt(2.5).
  const MeanInterval five = mean_interval({1, 2, 3, 4, 5});
  EXPECT_DOUBLE_EQ(five.mean, 3);
  EXPECT_NEAR(five.half, 2.7764 * std::sqrt(2.5 / 5), 1e-4);
  EXPECT_EQ(five.n, 5);
  // With one degree: 12.706.
  EXPECT_NEAR(mean_interval({0, 1}).half, 12.7062 * 0.5, 1e-4);
}

TEST(MeanInterval, NeedsTwoFiniteValues) {
  EXPECT_TRUE(std::isnan(mean_interval({}).mean));
  EXPECT_EQ(mean_interval({4}).mean, 4);
  EXPECT_TRUE(std::isnan(mean_interval({4}).half));
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(mean_interval({1, none, 3}).n, 2);
  EXPECT_EQ(mean_interval({1, none, 3}).mean, 2);
}

/// The seeds differ by far more than the settings; in pairs that cancels.
TEST(PairedDifference, LeavesOutWhatTheSeedDoesToBoth) {
  const MeanInterval difference = paired_difference({11, 21.1, 30.9, 41}, {10, 20, 30, 40});
  EXPECT_NEAR(difference.mean, 1, 1e-12);
  EXPECT_NEAR(difference.half, 3.1824 * std::sqrt(0.02 / 3 / 4), 1e-4);
  EXPECT_TRUE(difference.differs_from_zero());
  EXPECT_FALSE(mean_interval({1, 11.1, 20.9, -31}).differs_from_zero());
  EXPECT_THROW(paired_difference({1}, {1, 2}), std::invalid_argument);
}

}  // namespace
}  // namespace wobblebench::bench
