// Bootstrap intervals against distributions of resampled means that are known exactly.
#include "bench/evaluation/bootstrap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace wobblebench::bench {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

TEST(Bootstrap, FewValuesHaveNoInterval) {
  EXPECT_TRUE(std::isnan(bootstrap_mean({}).mean));
  const BootstrapMean one = bootstrap_mean({kNone, 3, std::numeric_limits<double>::infinity()});
  EXPECT_EQ(one.n, 1);
  EXPECT_EQ(one.mean, 3);
  EXPECT_TRUE(std::isnan(one.low) && std::isnan(one.high));
}

TEST(Bootstrap, EqualValuesHaveAnIntervalOfNoWidth) {
  const BootstrapMean equal = bootstrap_mean({2, 2, 2});
  EXPECT_EQ(equal.low, 2);
  EXPECT_EQ(equal.high, 2);
}

// Means of resamples of k ones among n values are binomial: with n = 20 and k = 6, shares of at
// most 0.10 have a probability of 0.035 in all, of at most 0.05 of 0.0076; of at least 0.50
// 0.048, of at least 0.55 0.017.
TEST(Bootstrap, HasTheQuantilesOfTheBinomial) {
  std::vector<double> values(20, 0.0);
  for (std::size_t i = 0; i < 6; ++i) values[i * 3] = 1;
  const BootstrapMean of = bootstrap_mean(values);
  EXPECT_NEAR(of.mean, 0.3, 1e-12);
  EXPECT_NEAR(of.low, 0.10, 1e-9);
  EXPECT_NEAR(of.high, 0.50, 1e-9);
}

}  // namespace
}  // namespace wobblebench::bench
