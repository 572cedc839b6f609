// Median, range, quantiles, root mean square and correlation of measurements.
#pragma once

#include <span>
#include <vector>

namespace wobblebench {

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

}  // namespace wobblebench
