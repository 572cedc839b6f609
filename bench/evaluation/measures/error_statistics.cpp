#include "bench/evaluation/measures/error_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/statistics.h"

namespace wobblebench::bench {

namespace {

constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();

}  // namespace

DepthStatistics depth_statistics(std::vector<double> errors_m) {
  DepthStatistics result{kUnset, kUnset, kUnset, kUnset, kUnset, static_cast<int>(errors_m.size())};
  if (errors_m.empty()) return result;
  double sum = 0, squares = 0;
  for (const double e : errors_m) {
    sum += e;
    squares += e * e;
  }
  const double n = static_cast<double>(errors_m.size());
  result.bias_m = sum / n;
  result.rms_m = std::sqrt(squares / n);
  result.median_m = quantile(errors_m, 0.5);
  for (double& e : errors_m) e = std::abs(e);
  result.max_m = *std::max_element(errors_m.begin(), errors_m.end());
  result.p95_m = quantile(std::move(errors_m), 0.95);
  return result;
}

NormalStatistics normal_statistics(std::vector<double> angles_rad) {
  NormalStatistics result{kUnset, kUnset, kUnset, static_cast<int>(angles_rad.size())};
  if (angles_rad.empty()) return result;
  result.mean_rad = std::accumulate(angles_rad.begin(), angles_rad.end(), 0.0) / result.n;
  result.median_rad = quantile(angles_rad, 0.5);
  result.p95_rad = quantile(std::move(angles_rad), 0.95);
  return result;
}

}  // namespace wobblebench::bench
