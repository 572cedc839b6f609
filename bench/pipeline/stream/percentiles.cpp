#include "bench/pipeline/stream/percentiles.h"

#include "base/statistics.h"

namespace wobblebench::bench {

Percentiles percentiles_of(const std::vector<double>& values_ms) {
  return {quantile(values_ms, 0.5),
          quantile(values_ms, 0.9),
          quantile(values_ms, 0.99),
          quantile(values_ms, 0.999),
          quantile(values_ms, 1),
          values_ms.size()};
}

}  // namespace wobblebench::bench
