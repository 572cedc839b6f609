// What a report says of a stage's times.
#pragma once

#include <cstddef>
#include <vector>

namespace wobblebench::bench {

/// Quantiles, ms.
struct Percentiles {
  double p50 = 0, p90 = 0, p99 = 0, p999 = 0, max = 0;
  std::size_t n = 0;
};
/// NaN without values.
Percentiles percentiles_of(const std::vector<double>& values_ms);

}  // namespace wobblebench::bench
