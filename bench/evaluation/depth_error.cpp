#include "bench/evaluation/depth_error.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/statistics.h"
#include "bench/evaluation/pixel_area.h"

namespace wobblebench::bench {

namespace {

constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();

DepthStatistics statistics(std::vector<double> errors) {
  DepthStatistics result{kUnset, kUnset, kUnset, kUnset, kUnset, static_cast<int>(errors.size())};
  if (errors.empty()) return result;
  double sum = 0, squares = 0;
  for (double e : errors) {
    sum += e;
    squares += e * e;
  }
  const double n = static_cast<double>(errors.size());
  result.bias_m = sum / n;
  result.rms_m = std::sqrt(squares / n);
  result.median_m = quantile_nearest(errors, 0.5);
  for (double& e : errors) e = std::abs(e);
  result.p95_m = quantile_nearest(errors, 0.95);
  result.max_m = *std::max_element(errors.begin(), errors.end());
  return result;
}

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
  // right x down points away from the viewer.
  const glm::dvec3 normal = -glm::cross(across, along);
  const double length = glm::length(normal);
  if (!(length > 0)) return {};
  return normal / length;
}

void count_surface(DepthError& result, double area_m2, bool missed) {
  ++result.surface;
  result.surface_m2 += area_m2;
  if (!missed) return;
  ++result.missed;
  result.missed_m2 += area_m2;
}

}  // namespace

DepthError measure_depth_error(const Image<float>& depth_m,
                               const Truth& truth,
                               const render::Camera& camera) {
  DepthError result;
  result.pixels = depth_m.width * depth_m.height;
  result.map_m = {depth_m.width, depth_m.height, kNoSurface};
  std::vector<double> errors, angles;
  for (int row = 0; row < depth_m.height; ++row) {
    for (int column = 0; column < depth_m.width; ++column) {
      const bool measured = std::isfinite(depth_m.at(column, row));
      const TruthKind kind = truth.kind.at(column, row);
      if (kind == TruthKind::surface) {
        count_surface(result, pixel_area_m2(truth, camera, column, row), !measured);
      }
      result.false_surface += kind == TruthKind::none && measured;
      result.outside_field += kind == TruthKind::outside_field;
      if (kind != TruthKind::surface || !measured) continue;
      const double error = static_cast<double>(depth_m.at(column, row)) -
                           static_cast<double>(truth.depth_m.at(column, row));
      errors.push_back(error);
      result.map_m.at(column, row) = static_cast<float>(error);
      if (const auto normal = measured_normal(depth_m, camera, column, row)) {
        const double cosine = glm::dot(*normal, glm::dvec3(truth.normal.at(column, row)));
        angles.push_back(std::acos(std::clamp(cosine, -1.0, 1.0)));
      }
    }
  }
  result.depth = statistics(std::move(errors));
  result.normal.n = static_cast<int>(angles.size());
  double sum = 0;
  for (double angle : angles) sum += angle;
  result.normal.mean_rad = angles.empty() ? kUnset : sum / static_cast<double>(angles.size());
  result.normal.p95_rad = quantile_nearest(std::move(angles), 0.95);
  return result;
}

}  // namespace wobblebench::bench
