// How far the median of a few measurements may lie from that of many.
#pragma once

#include <vector>

namespace wobblebench {

struct MedianInterval {
  double low = 0;
  double high = 0;
  /// Probability that the interval of measurements such as these holds the true median: at least
  /// 0.95, or that of the whole range where there are fewer than six.
  double coverage = 0;
};

/// Between the k-th smallest and the k-th largest of at least one value, with the largest k whose
/// coverage is 0.95 or more. Distribution-free: the number of values below the true median is
/// binomial with probability 1/2 (Conover, Practical Nonparametric Statistics, 3rd ed., 3.2).
MedianInterval median_interval(std::vector<double> values);

}  // namespace wobblebench
