#include "bench/exchange/export/depth_mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace wobblebench::bench {

namespace {

constexpr double kLargestStep_m = 3e-3;  // between neighbours of one triangle, in depth

}  // namespace

DepthMesh::DepthMesh(const Image<float>& depth_m, const render::Camera& camera)
    : depth_m_(depth_m), camera_(camera), number_(depth_m.width, depth_m.height, -1) {
  for (int row = 0; row < depth_m.height; ++row) {
    for (int column = 0; column < depth_m.width; ++column) {
      if (!has(column, row)) continue;
      number_.at(column, row) = static_cast<std::int32_t>(pixels_.size());
      pixels_.emplace_back(column, row);
    }
  }
}

bool DepthMesh::has(int column, int row) const {
  return column >= 0 && row >= 0 && column < depth_m_.width && row < depth_m_.height &&
         !std::isnan(depth_m_.at(column, row));
}

glm::dvec3 DepthMesh::point_m(const glm::ivec2& pixel) const {
  return camera_.ray(pixel.x, pixel.y).at(depth_m_.at(pixel.x, pixel.y));
}

glm::dvec3 DepthMesh::normal(const glm::ivec2& pixel) const {
  const glm::dvec3 across = difference(pixel, {1, 0}), along = difference(pixel, {0, 1});
  glm::dvec3 normal = glm::cross(across, along);
  const glm::dvec3 ray = camera_.ray(pixel.x, pixel.y).direction;
  if (glm::dot(normal, normal) == 0) return -ray;
  normal = glm::normalize(normal);
  return glm::dot(normal, ray) > 0 ? -normal : normal;
}

/// Whether the four pixels from this one on are of one piece of surface.
bool DepthMesh::joins(int column, int row) const {
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (const auto& [c, r] : {std::pair(0, 0), std::pair(1, 0), std::pair(0, 1), std::pair(1, 1)}) {
    if (!has(column + c, row + r)) return false;
    least = std::min<double>(least, depth_m_.at(column + c, row + r));
    most = std::max<double>(most, depth_m_.at(column + c, row + r));
  }
  return most - least <= kLargestStep_m;
}

bool DepthMesh::is_near(const glm::ivec2& pixel, const glm::ivec2& neighbour) const {
  return has(neighbour.x, neighbour.y) && std::abs(double{depth_m_.at(neighbour.x, neighbour.y)} -
                                                   depth_m_.at(pixel.x, pixel.y)) <= kLargestStep_m;
}

glm::dvec3 DepthMesh::difference(const glm::ivec2& pixel, const glm::ivec2& step) const {
  const glm::ivec2 before = is_near(pixel, pixel - step) ? pixel - step : pixel;
  const glm::ivec2 behind = is_near(pixel, pixel + step) ? pixel + step : pixel;
  return point_m(behind) - point_m(before);
}

std::vector<std::int32_t> DepthMesh::corners() const {
  std::vector<std::int32_t> corners;
  for (int row = 0; row + 1 < depth_m_.height; ++row) {
    for (int column = 0; column + 1 < depth_m_.width; ++column) {
      if (!joins(column, row)) continue;
      const std::int32_t a = number_.at(column, row), b = number_.at(column + 1, row);
      const std::int32_t c = number_.at(column, row + 1), d = number_.at(column + 1, row + 1);
      if (camera_.flipped) {
        corners.insert(corners.end(), {a, b, c, b, d, c});
      } else {
        corners.insert(corners.end(), {a, c, b, b, c, d});
      }
    }
  }
  return corners;
}

}  // namespace wobblebench::bench
