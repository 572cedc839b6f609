// Median, range, quantiles, root mean square and correlation of measurements.
#pragma once

#include <limits>
#include <span>
#include <vector>

namespace wobblebench {

/// What a statistic of no values is.
inline constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();

/// Quantile of fraction q in [0, 1], linear between the two values in order about index q (n - 1):
/// definition 7 of Hyndman and Fan, Am. Stat. 50, 361 (1996), the default of numpy and R. Every
/// median and percentile of a report is this one. NaN without values.
double quantile(std::vector<double> values, double q);

/// NaN without values.
double root_mean_square(std::span<const double> values);

/// Pearson's; NaN where one of the two does not vary. Both have the same length.
double correlation(std::span<const double> a, std::span<const double> b);

struct Spread {
  double median = 0;
  double min = 0;
  double max = 0;
};

/// Of at least one value; the median of an even number is the mean of the middle two.
Spread spread_of(std::vector<double> values);

struct Quartiles {
  double lower = 0;
  double median = 0;
  double upper = 0;
};

/// quantile() at 0.25, 0.5 and 0.75.
Quartiles quartiles_of(std::vector<double> values);

/// Quartiles of values[i] / references[i]. A slow drift between repeats cancels in each ratio.
Quartiles paired_ratio(std::vector<double> values, const std::vector<double>& references);

/// How far the median of a few measurements may lie from that of many.
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
