#include "render/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace wobblebench::render {
namespace {

/// Rotates two axes of a right-handed frame by an angle, `a` towards `b`.
void turn(glm::dvec3& a, glm::dvec3& b, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  const glm::dvec3 old_a = a;
  a = c * old_a + s * b;
  b = c * b - s * old_a;
}

}  // namespace

hw::Ray Camera::ray(double column, double row) const {
  const double half = 0.5 * image_size;
  const glm::dvec3 across = (column + 0.5 - half) * pixel_m() * right +  //
                            (row + 0.5 - half) * pixel_m() * down;
  if (projection == Projection::parallel) {
    return {center + across - plane_distance_m * forward, forward};
  }
  return {center - eye_distance_m * forward, glm::normalize(across + eye_distance_m * forward)};
}

PicturePoint Camera::project(const glm::dvec3& position_m) const {
  const glm::dvec3 offset = position_m - center;
  const double u = glm::dot(offset, right), v = glm::dot(offset, down);
  const double ahead = glm::dot(offset, forward);
  const bool parallel = projection == Projection::parallel;
  const double scale = parallel ? 1 : eye_distance_m / (ahead + eye_distance_m);
  const double depth_m =
      parallel ? ahead + plane_distance_m : glm::length(offset + eye_distance_m * forward);
  const double half = 0.5 * image_size;
  return {u * scale / pixel_m() + half - 0.5, v * scale / pixel_m() + half - 0.5, depth_m};
}

Camera make_camera(const RenderOptions& options) {
  const glm::dvec3 size = options.volume_of_interest.size_m;
  Camera camera;
  camera.projection = options.view.projection;
  camera.center = options.volume_of_interest.center_m;
  turn(camera.right, camera.forward, options.view.yaw_rad);
  turn(camera.forward, camera.down, options.view.pitch_rad);
  turn(camera.right, camera.down, options.view.roll_rad);
  camera.flipped = options.view.flip;
  if (camera.flipped) camera.right = -camera.right;
  camera.width_m = std::max(size.x, size.y);
  camera.plane_distance_m = 0.5 * glm::length(size);
  camera.eye_distance_m = options.view.eye_distance_m;
  camera.image_size = options.ray_casting.image_size;
  return camera;
}

Span clip_to_box(const hw::Ray& ray, const VolumeOfInterest& box) {
  const glm::dvec3 center = box.center_m, half = 0.5 * box.size_m;
  double from_m = 0, to_m = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double offset = ray.origin[axis] - center[axis], slope = ray.direction[axis];
    if (slope == 0) {
      if (std::abs(offset) > half[axis]) return {};
      continue;
    }
    const double one = (-half[axis] - offset) / slope, other = (half[axis] - offset) / slope;
    from_m = std::max(from_m, std::min(one, other));
    to_m = std::min(to_m, std::max(one, other));
  }
  return to_m < from_m ? Span{} : Span{from_m, to_m};
}

double step_m(const RenderOptions& options) {
  return options.volume_of_interest.size_m.z / options.ray_casting.steps;
}

}  // namespace wobblebench::render
