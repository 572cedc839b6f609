#include "base/median_interval.h"

#include <algorithm>
#include <cmath>

namespace wobblebench {

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
