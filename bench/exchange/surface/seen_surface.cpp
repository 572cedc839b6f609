#include "bench/exchange/surface/seen_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "base/statistics.h"
#include "bench/evaluation/measures/point_tree.h"

namespace wobblebench::bench {

namespace {

/// First and last row or column, clamped to the picture; empty where last < first.
struct Range {
  int first = 0;
  int last = -1;
};

Range clamped(double low, double high, int size) {
  const double most = size - 1;
  if (!(high >= 0 && low <= most)) return {};
  return {static_cast<int>(std::ceil(std::max(low, 0.0))),
          static_cast<int>(std::floor(std::min(high, most)))};
}

/// The indices of what may be seen in each row.
std::vector<std::vector<std::uint32_t>> by_rows(const std::vector<Range>& ranges, int rows) {
  std::vector<std::vector<std::uint32_t>> lists(static_cast<std::size_t>(rows));
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    for (int row = ranges[i].first; row <= ranges[i].last; ++row) {
      lists[static_cast<std::size_t>(row)].push_back(static_cast<std::uint32_t>(i));
    }
  }
  return lists;
}

/// Whether the camera's projection of a position means anything: it lies in front of the eye.
bool is_in_front(const render::Camera& camera, const glm::dvec3& position_m) {
  if (camera.projection == render::Projection::parallel) return true;
  const glm::dvec3 eye_m = camera.center - camera.eye_distance_m * camera.forward;
  return glm::dot(position_m - eye_m, camera.forward) > 0;
}

using Corners = std::array<glm::dvec3, 3>;

/// Columns and rows of a triangle's projection.
struct Footprint {
  Range columns, rows;
};

Footprint footprint_of(const Corners& corners, const render::Camera& camera) {
  const int size = camera.image_size;
  const auto seen = std::ranges::count_if(
      corners, [&](const glm::dvec3& corner) { return is_in_front(camera, corner); });
  if (seen == 0) return {};
  if (seen < 3) return {{0, size - 1}, {0, size - 1}};
  constexpr double kRounding = 1e-6;  // pixels
  glm::dvec2 low(INFINITY), high(-INFINITY);
  for (const glm::dvec3& corner : corners) {
    const render::PicturePoint at = camera.project(corner);
    low = glm::min(low, glm::dvec2(at.column, at.row));
    high = glm::max(high, glm::dvec2(at.column, at.row));
  }
  return {clamped(low.x - kRounding, high.x + kRounding, size),
          clamped(low.y - kRounding, high.y + kRounding, size)};
}

/// Distance along the ray to a triangle, NaN where it passes by (Moller and Trumbore 1997). Edges
/// belong to it, so that no ray slips between two triangles.
double distance_to(const Corners& corners, const hw::Ray& ray) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN(), kEdge = 1e-9;
  const glm::dvec3 a = corners[1] - corners[0], b = corners[2] - corners[0];
  const glm::dvec3 across = glm::cross(ray.direction, b);
  const double determinant = glm::dot(a, across);
  if (determinant == 0) return kNone;
  const glm::dvec3 start = ray.origin - corners[0];
  const double u = glm::dot(start, across) / determinant;
  const glm::dvec3 along = glm::cross(start, a);
  const double v = glm::dot(ray.direction, along) / determinant;
  if (!(u >= -kEdge && v >= -kEdge && u + v <= 1 + kEdge)) return kNone;
  return glm::dot(b, along) / determinant;
}

Corners corners_of(const phantoms::TriangleMesh& mesh, std::size_t triangle) {
  const auto& index = mesh.triangles[triangle];
  return {mesh.vertices[index[0]], mesh.vertices[index[1]], mesh.vertices[index[2]]};
}

/// A point in the picture.
struct SplatPoint {
  double column = 0, row = 0;
  double depth_m = 0;
  double radius = 0;  ///< pixels
};

std::vector<SplatPoint> projected(const std::vector<glm::dvec3>& points_m,
                                  const render::Camera& camera,
                                  double radius_m) {
  std::vector<SplatPoint> splats;
  const bool is_parallel = camera.projection == render::Projection::parallel;
  for (const glm::dvec3& point_m : points_m) {
    if (!is_in_front(camera, point_m)) continue;
    const render::PicturePoint at = camera.project(point_m);
    const double nearness =
        is_parallel ? 1
                    : camera.eye_distance_m / (camera.eye_distance_m +
                                               glm::dot(point_m - camera.center, camera.forward));
    splats.push_back({at.column, at.row, at.depth_m, radius_m * nearness / camera.pixel_m()});
  }
  return splats;
}

/// Calls body(column, squared distance from the pixel's centre) for the pixels of a row that a
/// point covers.
template <class Body>
void for_each_covered(const SplatPoint& point, int row, int size, const Body& body) {
  const double above = row - point.row;
  const double half2 = point.radius * point.radius - above * above;
  if (half2 < 0) return;
  const double half = std::sqrt(half2);
  const Range columns = clamped(point.column - half, point.column + half, size);
  for (int column = columns.first; column <= columns.last; ++column) {
    const double aside = column - point.column;
    body(column, aside * aside + above * above);
  }
}

void splat_row(const std::vector<SplatPoint>& splats,
               const std::vector<std::uint32_t>& in_row,
               int row,
               double window_m,
               Image<float>& depth_m) {
  const int size = depth_m.width;
  const auto count = static_cast<std::size_t>(size);
  std::vector<double> nearest_m(count, INFINITY), least2(count, INFINITY);
  for (const std::uint32_t i : in_row) {
    for_each_covered(splats[i], row, size, [&](int column, double) {
      double& nearest = nearest_m[static_cast<std::size_t>(column)];
      nearest = std::min(nearest, splats[i].depth_m);
    });
  }
  for (const std::uint32_t i : in_row) {
    for_each_covered(splats[i], row, size, [&](int column, double distance2) {
      const auto slot = static_cast<std::size_t>(column);
      if (splats[i].depth_m > nearest_m[slot] + window_m || distance2 >= least2[slot]) return;
      least2[slot] = distance2;
      depth_m.at(column, row) = static_cast<float>(splats[i].depth_m);
    });
  }
}

std::vector<glm::dvec3> without_copies(std::vector<glm::dvec3> points_m) {
  const auto key = [](const glm::dvec3& p) { return std::array{p.x, p.y, p.z}; };
  std::ranges::sort(points_m, {}, key);
  points_m.erase(std::unique(points_m.begin(), points_m.end()), points_m.end());
  return points_m;
}

}  // namespace

Image<float> depth_of_mesh(const phantoms::TriangleMesh& mesh, const render::View& view) {
  const int size = view.camera.image_size;
  std::vector<Range> columns, rows;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Footprint footprint = footprint_of(corners_of(mesh, i), view.camera);
    columns.push_back(footprint.columns);
    rows.push_back(footprint.rows);
  }
  const auto lists = by_rows(rows, size);
  Image<float> depth_m(size, size, kNoSurface);
  parallel_rows(size, [&](int row) {
    for (const std::uint32_t i : lists[static_cast<std::size_t>(row)]) {
      const Corners corners = corners_of(mesh, i);
      for (int column = columns[i].first; column <= columns[i].last; ++column) {
        const hw::Ray ray = view.camera.ray(column, row);
        const render::Span span = render::clip_to_box(ray, view.box);
        const double distance_m = distance_to(corners, ray);
        if (!(distance_m >= span.from_m && distance_m <= span.to_m)) continue;
        float& nearest_m = depth_m.at(column, row);
        // NaN is replaced by any.
        if (!(nearest_m <= static_cast<float>(distance_m))) {
          nearest_m = static_cast<float>(distance_m);
        }
      }
    }
  });
  return depth_m;
}

Image<float> depth_of_points(const std::vector<glm::dvec3>& points_m,
                             const render::View& view,
                             double radius_m) {
  const int size = view.camera.image_size;
  const auto splats = projected(points_in_box(points_m, view), view.camera, radius_m);
  std::vector<Range> rows;
  rows.reserve(splats.size());
  for (const SplatPoint& point : splats) {
    rows.push_back(clamped(point.row - point.radius, point.row + point.radius, size));
  }
  const auto lists = by_rows(rows, size);
  Image<float> depth_m(size, size, kNoSurface);
  parallel_rows(size, [&](int row) {
    splat_row(splats, lists[static_cast<std::size_t>(row)], row, 4 * radius_m, depth_m);
  });
  return depth_m;
}

std::vector<glm::dvec3> points_in_box(const std::vector<glm::dvec3>& points_m,
                                      const render::View& view) {
  const auto& [center_m, size_m] = view.box;
  std::vector<glm::dvec3> inside;
  for (const glm::dvec3& point_m : points_m) {
    const glm::dvec3 from_center_m = glm::abs(point_m - center_m);
    const glm::dvec3 beyond_m = from_center_m - 0.5 * size_m;
    if (std::max({beyond_m.x, beyond_m.y, beyond_m.z}) <= 0) inside.push_back(point_m);
  }
  return inside;
}

double point_spacing_m(const std::vector<glm::dvec3>& points_m) {
  constexpr std::size_t kMostQueries = 20000;
  const std::vector<glm::dvec3> different = without_copies(points_m);
  if (different.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  const TreePoints points{different};
  const PointTree tree(3, points);
  const std::size_t step = (different.size() + kMostQueries - 1) / kMostQueries;
  std::vector<double> distances_m;
  for (std::size_t i = 0; i < different.size(); i += step) {
    std::array<std::uint32_t, 2> index{};
    std::array<double, 2> squared{};  // of the point itself, and of the next one
    tree.knnSearch(&different[i].x, 2, index.data(), squared.data());
    distances_m.push_back(std::sqrt(squared[1]));
  }
  return quantile(std::move(distances_m), 0.95);
}

}  // namespace wobblebench::bench
