// Intervals of means of values whose distribution is not known.
#pragma once

#include <vector>

namespace wobblebench::bench {

/// A mean and its 95 % interval: the 2.5th and 97.5th percentile of the means of 2000 resamples
/// with replacement (Efron and Tibshirani, An Introduction to the Bootstrap, 13.3). The same values
/// in the same order have the same interval. Values that are not finite are left out; NaN without
/// values, no interval (NaN) for fewer than two.
struct BootstrapMean {
  double mean = 0, low = 0, high = 0;
  int n = 0;
};
BootstrapMean bootstrap_mean(std::vector<double> values);

}  // namespace wobblebench::bench
