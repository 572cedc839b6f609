#include "bench/studies/extremes/surface_bounds.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "bench/studies/extremes/pass_bounds.h"
#include "render/geometry/lighting.h"

namespace wobblebench::bench {

namespace {

constexpr double kMostTurn = 2;  // between two unit vectors

}  // namespace

SurfaceBounds::SurfaceBounds(const Image<double>& depth_m,
                             const render::RenderOptions& options,
                             double position_m)
    : depth_m_(depth_m),
      options_(options),
      camera_(make_camera(options)),
      position_m_(position_m) {}

/// The product of the surface's tangents, one-sided where a neighbour is missing; `lengths_m`: the
/// sum of their lengths.
glm::dvec3 SurfaceBounds::across(int column, int row, double& lengths_m) const {
  const auto point = [&](int c, int r, double other_m) {
    const bool inside = c >= 0 && r >= 0 && c < depth_m_.width && r < depth_m_.height;
    const double z_m = inside ? depth_m_.at(c, r) : kNoSurface;
    return std::pair(!std::isnan(z_m), camera_.ray(c, r).at(std::isnan(z_m) ? other_m : z_m));
  };
  const auto tangent = [&](int right, int down) {
    const double z_m = depth_m_.at(column, row);
    const auto [has_before, before] = point(column - right, row - down, z_m);
    const auto [has_after, after] = point(column + right, row + down, z_m);
    const glm::dvec3 here = camera_.ray(column, row).at(z_m);
    if (has_before == has_after) return after - before;
    return has_after ? after - here : here - before;
  };
  const glm::dvec3 one = tangent(1, 0), other = tangent(0, 1);
  lengths_m = glm::length(one) + glm::length(other);
  return glm::cross(one, other);
}

double SurfaceBounds::normal(int column, int row) const {
  double lengths_m = 0;
  const double area = glm::length(across(column, row, lengths_m));
  const double product_m2 = 2 * position_m_ * lengths_m;
  return area > product_m2 ? std::min(kMostTurn, 2 * product_m2 / area) : kMostTurn;
}

double SurfaceBounds::colour(int column, int row) const {
  const render::ShadingOptions& o = options_.shading;
  const hw::Ray ray = camera_.ray(column, row);
  const glm::dvec3 surface = ray.at(depth_m_.at(column, row));
  glm::dvec3 light = light_direction_in_probe(o, camera_);
  double of_light = 8 * kUnitRoundoff;
  if (o.light == render::Light::point) {
    const glm::dvec3 offset = light_position_in_probe_m(o, camera_) - surface;
    const double distance_m = glm::length(offset);
    of_light = std::min(kMostTurn, 2 * position_m_ / std::max(distance_m, 1e-30));
    light = distance_m > 0 ? offset / distance_m : -ray.direction;
  }
  const double turn = std::min(kMostTurn, normal(column, row) + of_light);
  const double halfway = std::max(glm::length(light - ray.direction), 1e-20);
  const double of_halfway = std::min(kMostTurn, turn + 2 * (of_light + kUnitRoundoff) / halfway);
  double lengths_m = 0;
  const glm::dvec3 away = across(column, row, lengths_m);
  const double facing = glm::dot(away, light) / std::max(glm::length(away), 1e-300);
  const bool either_side = std::abs(facing) <= turn;  // of the light: with a highlight or without
  const double highlight = either_side ? 1.0 : std::min(1.0, o.shininess * of_halfway);
  const double base = std::max({o.base_rgb.x, o.base_rgb.y, o.base_rgb.z});
  return 16 * kUnitRoundoff * (1 + o.shininess) + base * o.diffuse * turn + o.specular * highlight;
}

}  // namespace wobblebench::bench
