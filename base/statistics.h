// Median, range and quartiles of repeated measurements.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace wobblebench {

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

struct Quartiles {
  double lower = 0;
  double median = 0;
  double upper = 0;
};

/// Of at least one value, linear between neighbours in order.
inline Quartiles quartiles_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    const double place = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const auto above = std::min(below + 1, values.size() - 1);
    return std::lerp(values[below], values[above], place - std::floor(place));
  };
  return {at(0.25), at(0.5), at(0.75)};
}

/// Of values[i] / references[i]: what drifts between one repeat and the next touches both alike.
inline Quartiles paired_ratio(std::vector<double> values, const std::vector<double>& references) {
  std::transform(
      values.begin(), values.end(), references.begin(), values.begin(), std::divides<>());
  return quartiles_of(values);
}

}  // namespace wobblebench
