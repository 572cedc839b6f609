#include "bench/evaluation/bootstrap.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include "base/hash.h"
#include "base/statistics.h"

namespace wobblebench::bench {

namespace {

constexpr int kResamples = 2000;
constexpr double kLow = 0.025, kHigh = 0.975;

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

BootstrapMean bootstrap_mean(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  BootstrapMean result{kUnset, kUnset, kUnset, static_cast<int>(values.size())};
  if (values.empty()) return result;
  result.mean = mean_of(values);
  if (values.size() < 2) return result;
  std::vector<double> means, resample(values.size());
  std::uint64_t drawn = 0;
  for (int i = 0; i < kResamples; ++i) {
    for (double& value : resample) {
      const double unit = unit_interval(mix64(++drawn * kGoldenGamma));
      value = values[static_cast<std::size_t>(unit * static_cast<double>(values.size()))];
    }
    means.push_back(mean_of(resample));
  }
  result.low = quantile(means, kLow);
  result.high = quantile(means, kHigh);
  return result;
}

}  // namespace wobblebench::bench
