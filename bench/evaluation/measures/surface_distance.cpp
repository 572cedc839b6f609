#include "bench/evaluation/measures/surface_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/statistics.h"
#include "bench/evaluation/measures/depth_error.h"
#include "bench/evaluation/measures/point_tree.h"

namespace wobblebench::bench {

namespace {

double segment_distance_m(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double length2 = glm::dot(along, along);
  const double t = length2 > 0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0;
  return glm::distance(p, a + t * along);
}

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

double triangle_distance_m(const glm::dvec3& p,
                           const glm::dvec3& a,
                           const glm::dvec3& b,
                           const glm::dvec3& c) {
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const auto inside = [&](const glm::dvec3& from, const glm::dvec3& to) {
    return glm::dot(glm::cross(to - from, p - from), normal) >= 0;
  };
  const double size = glm::length(normal);
  if (size > 0 && inside(a, b) && inside(b, c) && inside(c, a)) {
    return std::abs(glm::dot(p - a, normal)) / size;
  }
  return std::min(
      {segment_distance_m(p, a, b), segment_distance_m(p, b, c), segment_distance_m(p, c, a)});
}

struct DepthSurface::Tree {
  explicit Tree(const std::vector<glm::dvec3>& at) : points{at}, index(3, points) {}
  TreePoints points;
  PointTree index;
};

DepthSurface::DepthSurface(const Image<float>& depth_m, const render::Camera& camera)
    : depth_m_(depth_m), vertex_of_(depth_m.width, depth_m.height, -1) {
  for (int row = 0; row < depth_m.height; ++row) {
    for (int column = 0; column < depth_m.width; ++column) {
      if (!std::isfinite(depth_m.at(column, row))) continue;
      vertex_of_.at(column, row) = static_cast<int>(points_.size());
      pixel_of_.push_back(row * depth_m.width + column);
      points_.push_back(camera.ray(column, row).at(static_cast<double>(depth_m.at(column, row))));
    }
  }
  if (!points_.empty()) tree_ = std::make_unique<Tree>(points_);
}

DepthSurface::~DepthSurface() = default;

int DepthSurface::vertex(int column, int row) const {
  if (column < 0 || row < 0 || column >= depth_m_.width || row >= depth_m_.height) return -1;
  return vertex_of_.at(column, row);
}

bool DepthSurface::joined(int a, int b) const {
  if (b < 0) return false;
  const auto depth = [&](int v) {
    return depth_m_.pixels[static_cast<std::size_t>(pixel_of_[static_cast<std::size_t>(v)])];
  };
  return std::abs(depth(a) - depth(b)) <= static_cast<float>(kSurfaceJump_m);
}

double DepthSurface::distance_m(const glm::dvec3& position_m) const {
  std::uint32_t nearest = 0;
  double squared = 0;
  tree_->index.knnSearch(&position_m[0], 1, &nearest, &squared);
  double least_m = std::sqrt(squared);
  const int pixel = pixel_of_[nearest], column = pixel % depth_m_.width,
            row = pixel / depth_m_.width;
  const int here = static_cast<int>(nearest);
  // About the vertex, each quarter turn: two triangles of the square between its neighbours.
  constexpr std::array<std::array<int, 2>, 8> kAround = {
      {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
  for (std::size_t i = 0; i < kAround.size(); ++i) {
    const auto& [c0, r0] = kAround[i];
    const auto& [c1, r1] = kAround[(i + 1) % kAround.size()];
    const int a = vertex(column + c0, row + r0), b = vertex(column + c1, row + r1);
    if (!joined(here, a) || !joined(here, b) || !joined(a, b)) continue;
    least_m = std::min(least_m,
                       triangle_distance_m(position_m,
                                           points_[nearest],
                                           points_[static_cast<std::size_t>(a)],
                                           points_[static_cast<std::size_t>(b)]));
  }
  return least_m;
}

SurfaceDistance surface_distance(const Image<float>& depth_m,
                                 const Truth& truth,
                                 const render::Camera& camera) {
  const bool knows_crossings = !truth.crossing_m.pixels.empty();
  const std::array maps_m = {
      &depth_m, &truth.depth_m, knows_crossings ? &truth.crossing_m : &truth.depth_m};
  std::array<std::optional<DepthSurface>, maps_m.size()> surfaces;
  parallel_rows(static_cast<int>(maps_m.size()), [&](int i) {
    const auto which = static_cast<std::size_t>(i);
    surfaces[which].emplace(*maps_m[which], camera);
  });
  const auto& [found, visible, there] = surfaces;
  std::vector<double> to_true = distances(*found, *there);
  const std::vector<double> to_found = distances(*visible, *found);
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
