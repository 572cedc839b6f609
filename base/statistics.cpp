#include "base/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>

namespace wobblebench {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double interpolated(const std::vector<double>& sorted, double q) {
  if (sorted.empty()) return kNone;
  const double position = q * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const auto above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], position - std::floor(position));
}

}  // namespace

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return kNone;
  const double position = q * static_cast<double>(values.size() - 1);
  const auto below = values.begin() + static_cast<std::ptrdiff_t>(position);
  std::nth_element(values.begin(), below, values.end());
  const auto above = below + 1 < values.end() ? std::min_element(below + 1, values.end()) : below;
  return std::lerp(*below, *above, position - std::floor(position));
}

double root_mean_square(std::span<const double> values) {
  double squares = 0;
  for (const double value : values) squares += value * value;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

double correlation(std::span<const double> a, std::span<const double> b) {
  const double n = static_cast<double>(a.size());
  double mean_a = 0, mean_b = 0, aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    mean_a += a[i] / n;
    mean_b += b[i] / n;
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
    ab += (a[i] - mean_a) * (b[i] - mean_b);
  }
  return ab / std::sqrt(aa * bb);
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

namespace {

constexpr double kCoverage = 0.95;

/// Probability of at most k of n.
double binomial_half(int k, int n) {
  double sum = 0;
  for (int i = 0; i <= k; ++i) {
    sum += std::exp(std::lgamma(n + 1) - std::lgamma(i + 1) - std::lgamma(n - i + 1) -
                    n * std::log(2.0));
  }
  return sum;
}

}  // namespace

MedianInterval median_interval(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const int n = static_cast<int>(values.size());
  int k = 0;  // values left out on either side
  while (k + 1 < n - k - 1 && 1 - 2 * binomial_half(k + 1, n) >= kCoverage) ++k;
  const auto at = static_cast<std::size_t>(k);
  return {values.at(at), values.at(values.size() - 1 - at), 1 - 2 * binomial_half(k, n)};
}

}  // namespace wobblebench
