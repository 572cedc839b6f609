// Median, range and quantiles of repeated measurements.
//
// x[0] <= x[1] <= … <= x[n - 1] are the values in order, q is in [0, 1]. The definitions of
// quantiles differ for few values (Hyndman and Fan, Am. Stat. 50, 361 (1996)); reports keep theirs:
//   quantile_linear   between the two values about x[q (n - 1)]   quartiles of the tables' ratios
//   quantile_nearest  x[round(q (n - 1))]                         depth and normal errors (P95)
//   quantile_lower    x[floor(q (n - 1))]                         errors of the rungs (P95)
//   quantile_upper    x[min(floor(q n), n - 1)]                   times of cancel()
// All are NaN where there are no values.
#pragma once

#include <vector>

namespace wobblebench {

/// Linear between neighbours: their definition 7.
double quantile_linear(std::vector<double> values, double q);

/// An observed value; halfway between two of them the upper one.
double quantile_nearest(std::vector<double> values, double q);

/// An observed value; between two of them the lower one.
double quantile_lower(std::vector<double> values, double q);

/// The smallest observed value that more than a fraction q of the values does not exceed.
double quantile_upper(std::vector<double> values, double q);

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

/// quantile_linear() at 0.25, 0.5 and 0.75.
Quartiles quartiles_of(std::vector<double> values);

/// Quartiles of values[i] / references[i]. A slow drift between repeats cancels in each ratio.
Quartiles paired_ratio(std::vector<double> values, const std::vector<double>& references);

}  // namespace wobblebench
