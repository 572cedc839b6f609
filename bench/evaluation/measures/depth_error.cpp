#include "bench/evaluation/measures/depth_error.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/statistics.h"
#include "bench/evaluation/truth/truth.h"
#include "bench/results/error.h"

namespace wobblebench::bench {

namespace {

/// Normal of the measured surface, towards the viewer; none at its rim.
std::optional<glm::dvec3> measured_normal(const Image<float>& depth_m,
                                          const render::Camera& camera,
                                          int column,
                                          int row) {
  if (column < 1 || row < 1 || column + 1 >= depth_m.width || row + 1 >= depth_m.height) return {};
  const auto point = [&](int c, int r) {
    return camera.ray(c, r).at(static_cast<double>(depth_m.at(c, r)));
  };
  const glm::dvec3 across = point(column + 1, row) - point(column - 1, row);
  const glm::dvec3 along = point(column, row + 1) - point(column, row - 1);
  // right x down points away from the viewer, but in a mirrored picture towards them.
  const glm::dvec3 normal = (camera.flipped ? 1.0 : -1.0) * glm::cross(across, along);
  const double length = glm::length(normal);
  if (!(length > 0)) return {};
  return normal / length;
}

/// The normal where a pixel's neighbours are of its own surface, or else one towards the viewer.
glm::dvec3 area_normal(const Image<float>& depth_m,
                       const std::optional<glm::dvec3>& normal,
                       const hw::Ray& ray,
                       int column,
                       int row) {
  if (!normal) return -ray.direction;
  const auto jump = [&](int c, int r) {
    return std::abs(depth_m.at(c, r) - depth_m.at(column, row)) >
           static_cast<float>(kSurfaceJump_m);
  };
  const bool alone = jump(column - 1, row) || jump(column + 1, row) || jump(column, row - 1) ||
                     jump(column, row + 1);
  return alone ? -ray.direction : *normal;
}

/// Adds what one pixel shows to a row's counts and areas, and sets it in the maps of `maps`.
void compare_pixel(const Image<float>& depth_m,
                   const Truth& truth,
                   const render::Camera& camera,
                   int column,
                   int row,
                   DepthError& counts,
                   DepthError& maps) {
  const TruthKind kind = truth.kind.at(column, row);
  const float found_m = depth_m.at(column, row);
  const bool found = std::isfinite(found_m);
  counts.outside_field += kind == TruthKind::outside_field;
  counts.grazing += kind == TruthKind::grazing;
  counts.shadowed += kind == TruthKind::shadowed;
  if (kind == TruthKind::surface) {
    const double area_m2 = pixel_area_m2(truth, camera, column, row);
    ++counts.surface;
    counts.surface_m2 += area_m2;
    if (!found) counts.missed_m2 += area_m2;
    counts.missed += !found;
  }
  if (!found) return;
  const auto normal = measured_normal(depth_m, camera, column, row);
  const hw::Ray ray = camera.ray(column, row);
  const double area_m2 = pixel_area_m2(
      camera, ray, static_cast<double>(found_m), area_normal(depth_m, normal, ray, column, row));
  counts.found_m2 += area_m2;
  if (kind == TruthKind::none) {
    ++counts.false_surface;
    counts.false_m2 += area_m2;
    return;
  }
  const double error_m =
      static_cast<double>(found_m) - static_cast<double>(truth.any_depth_m(column, row));
  const bool seen = kind == TruthKind::surface;
  (seen ? maps.map_m : maps.unseen_map_m).at(column, row) = static_cast<float>(error_m);
  if (!seen || !normal) return;
  const double cosine = glm::dot(*normal, glm::dvec3(truth.normal.at(column, row)));
  maps.normal_rad.at(column, row) = static_cast<float>(std::acos(std::clamp(cosine, -1.0, 1.0)));
}

void add(const DepthError& row, DepthError& sum) {
  for (const auto count : {&DepthError::surface,
                           &DepthError::missed,
                           &DepthError::false_surface,
                           &DepthError::outside_field,
                           &DepthError::grazing,
                           &DepthError::shadowed}) {
    sum.*count += row.*count;
  }
  for (const auto area : {&DepthError::surface_m2,
                          &DepthError::missed_m2,
                          &DepthError::found_m2,
                          &DepthError::false_m2}) {
    sum.*area += row.*area;
  }
}

std::vector<double> values_of(const Image<float>& map) {
  std::vector<double> values;
  for (const float value : map.pixels) {
    if (!std::isnan(value)) values.push_back(static_cast<double>(value));
  }
  return values;
}

}  // namespace

DepthStatistics depth_statistics(std::vector<double> errors_m) {
  DepthStatistics result{
      kUnset, kUnset, kUnset, kUnset, kUnset, kUnset, static_cast<int>(errors_m.size())};
  if (errors_m.empty()) return result;
  result.bias_m = std::accumulate(errors_m.begin(), errors_m.end(), 0.0) / result.n;
  result.rms_m = root_mean_square(errors_m);
  result.median_m = quantile(errors_m, 0.5);
  for (double& e : errors_m) e = std::abs(e);
  result.max_m = *std::max_element(errors_m.begin(), errors_m.end());
  const auto outliers = std::ranges::count_if(errors_m, [](double e) { return e > kOutlier_m; });
  result.outlier_share = static_cast<double>(outliers) / result.n;
  result.p95_m = quantile(std::move(errors_m), 0.95);
  return result;
}

void describe(const DepthStatistics& depth, Measurements& to) {
  to.add(error::kBias, depth.bias_m / kMillimetre);
  to.add(error::kRms, depth.rms_m / kMillimetre);
  to.add(error::kMedian, depth.median_m / kMillimetre);
  to.add(error::kP95, depth.p95_m / kMillimetre);
  to.add(error::kMax, depth.max_m / kMillimetre);
  to.add(error::kOutliers, 100 * depth.outlier_share);
  to.add(error::kPixels, depth.n);
}

void describe(const DepthError& found, Measurements& to) {
  describe(found.depth, to);
  const bool in_view = found.surface_in_view();
  to.add(error::kMissed, in_view ? found.missed_percent() : kUnset);
  to.add(error::kFalse, in_view ? found.false_percent() : kUnset);
}

NormalStatistics normal_statistics(std::vector<double> angles_rad) {
  NormalStatistics result{kUnset, kUnset, kUnset, static_cast<int>(angles_rad.size())};
  if (angles_rad.empty()) return result;
  result.mean_rad = std::accumulate(angles_rad.begin(), angles_rad.end(), 0.0) / result.n;
  result.median_rad = quantile(angles_rad, 0.5);
  result.p95_rad = quantile(std::move(angles_rad), 0.95);
  return result;
}

DepthError measure_depth_error(const Image<float>& depth_m,
                               const Truth& truth,
                               const render::Camera& camera) {
  DepthError result;
  result.pixels = depth_m.width * depth_m.height;
  result.map_m = result.normal_rad =
      result.unseen_map_m = {depth_m.width, depth_m.height, kNoSurface};
  std::vector<DepthError> rows(static_cast<std::size_t>(depth_m.height));
  parallel_rows(depth_m.height, [&](int row) {
    for (int column = 0; column < depth_m.width; ++column) {
      DepthError& counts = rows[static_cast<std::size_t>(row)];
      compare_pixel(depth_m, truth, camera, column, row, counts, result);
    }
  });
  for (const DepthError& row : rows) add(row, result);
  result.depth = depth_statistics(values_of(result.map_m));
  result.normal = normal_statistics(values_of(result.normal_rad));
  return result;
}

}  // namespace wobblebench::bench
