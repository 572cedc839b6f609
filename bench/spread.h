// Median and range of repeated measurements.
#pragma once

#include <algorithm>
#include <vector>

namespace wobblebench::bench {

struct Spread {
  double median = 0;
  double min = 0;
  double max = 0;
};

/// Of at least one value; the median of an even number is the mean of the middle two.
inline Spread spread_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {0.5 * (values.at((n - 1) / 2) + values.at(n / 2)), values.front(), values.back()};
}

}  // namespace wobblebench::bench
