#include "base/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>

namespace wobblebench {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// x[index].
double order_statistic(std::vector<double>& values, std::size_t index) {
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(index);
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

double interpolated(const std::vector<double>& sorted, double q) {
  if (sorted.empty()) return kNone;
  const double position = q * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const auto above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], position - std::floor(position));
}

}  // namespace

double quantile_linear(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return interpolated(values, q);
}

double quantile_nearest(std::vector<double> values, double q) {
  if (values.empty()) return kNone;
  const auto index = std::lround(q * static_cast<double>(values.size() - 1));
  return order_statistic(values, static_cast<std::size_t>(index));
}

double quantile_lower(std::vector<double> values, double q) {
  if (values.empty()) return kNone;
  return order_statistic(values,
                         static_cast<std::size_t>(q * static_cast<double>(values.size() - 1)));
}

double quantile_upper(std::vector<double> values, double q) {
  if (values.empty()) return kNone;
  const auto index = static_cast<std::size_t>(q * static_cast<double>(values.size()));
  return order_statistic(values, std::min(index, values.size() - 1));
}

Spread spread_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {0.5 * (values.at((n - 1) / 2) + values.at(n / 2)), values.front(), values.back()};
}

Quartiles quartiles_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {interpolated(values, 0.25), interpolated(values, 0.5), interpolated(values, 0.75)};
}

Quartiles paired_ratio(std::vector<double> values, const std::vector<double>& references) {
  std::transform(
      values.begin(), values.end(), references.begin(), values.begin(), std::divides<>());
  return quartiles_of(values);
}

}  // namespace wobblebench
