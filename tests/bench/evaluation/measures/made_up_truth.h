// Truths with closed forms, without a phantom.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>

#include "bench/evaluation/truth/truth.h"
#include "render/camera.h"

namespace wobblebench::bench {

/// A camera of `size` pixels over 0.1 m.
inline render::Camera camera_of(int size, render::Projection projection) {
  render::RenderOptions options;
  options.ray_casting.image_size = size;
  options.view.projection = projection;
  return render::make_camera(options);
}

/// A flat true surface that faces the viewer and fills the picture.
inline Truth flat_truth(int size, float depth_m = 0.1f) {
  return {
      {size, size, depth_m}, {size, size, glm::vec3(0, 0, -1)}, {size, size, TruthKind::surface}};
}

/// The near side of a ball whose centre lies on the axis of the camera.
inline Truth ball_truth(const render::Camera& camera, double center_m, double radius_m) {
  const int size = camera.image_size;
  Truth truth{{size, size, kNoSurface}, {size, size}, {size, size, TruthKind::none}};
  const hw::Ray axis = camera.ray(0.5 * size - 0.5, 0.5 * size - 0.5);
  const glm::dvec3 center = axis.at(center_m);
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const hw::Ray ray = camera.ray(column, row);
      const double along = glm::dot(center - ray.origin, ray.direction);
      const double off = glm::length(ray.at(along) - center);
      if (off >= radius_m) continue;
      const double depth_m = along - std::sqrt(radius_m * radius_m - off * off);
      truth.depth_m.at(column, row) = static_cast<float>(depth_m);
      truth.normal.at(column, row) = (ray.at(depth_m) - center) / radius_m;
      truth.kind.at(column, row) = TruthKind::surface;
    }
  }
  return truth;
}

}  // namespace wobblebench::bench
