#include "bench/evaluation/measures/surface_distance.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/statistics.h"
#include "bench/evaluation/measures/depth_surface.h"

namespace wobblebench::bench {

namespace {

constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();

std::vector<double> distances(const DepthSurface& from, const DepthSurface& to) {
  if (to.points().empty()) return {};
  std::vector<double> result(from.points().size());
  parallel_ranges(static_cast<int>(result.size()), 0, [&](int first, int last) {
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
      result[i] = to.distance_m(from.points()[i]);
    }
  });
  return result;
}

double mean(const std::vector<double>& values) {
  if (values.empty()) return kUnset;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

DirectedDistance directed(const std::vector<double>& values) {
  if (values.empty()) return {kUnset, kUnset, kUnset, 0};
  return {mean(values),
          quantile(values, 0.95),
          *std::max_element(values.begin(), values.end()),
          static_cast<int>(values.size())};
}

}  // namespace

SurfaceDistance surface_distance(const Image<float>& depth_m,
                                 const Truth& truth,
                                 const render::Camera& camera) {
  const DepthSurface found(depth_m, camera), visible(truth.depth_m, camera);
  std::vector<double> to_true;
  if (truth.crossing_m.pixels.empty()) {
    to_true = distances(found, visible);
  } else {
    to_true = distances(found, DepthSurface(truth.crossing_m, camera));
  }
  const std::vector<double> to_found = distances(visible, found);
  SurfaceDistance result{directed(to_true), directed(to_found)};
  result.hausdorff95_m = result.found_to_true.n == 0 || result.true_to_found.n == 0
                             ? kUnset
                             : std::max(result.found_to_true.p95_m, result.true_to_found.p95_m);
  std::vector<double> both = std::move(to_true);
  both.insert(both.end(), to_found.begin(), to_found.end());
  result.mean_m = mean(both);
  result.p95_m = quantile(std::move(both), 0.95);
  return result;
}

}  // namespace wobblebench::bench
