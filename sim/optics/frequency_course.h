// How the centre frequency of a scene's pulses falls with range.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace wobblebench::sim {

/// Over the frequency sent, at ranges (i + 1/2) * step_m; empty: 1 everywhere. Held beyond its end.
struct FrequencyCourse {
  double step_m = 0;
  std::vector<float> ratio;

  double at(double range_m) const {
    if (ratio.empty()) return 1;
    const auto i = static_cast<std::size_t>(std::max(0.0, range_m / step_m));
    return static_cast<double>(ratio[std::min(i, ratio.size() - 1)]);
  }
};

}  // namespace wobblebench::sim
