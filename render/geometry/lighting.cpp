#include "render/geometry/lighting.h"

#include <cmath>

namespace wobblebench::render {

glm::dvec3 light_direction(const ShadingOptions& options) {
  const double up = options.light_up_rad, left = options.light_left_rad;
  return {-std::sin(left) * std::cos(up), -std::sin(up), -std::cos(left) * std::cos(up)};
}

glm::dvec3 light_position_m(const ShadingOptions& options, const Camera& camera) {
  const bool parallel = camera.projection == Projection::parallel;
  const double ahead_m = parallel ? camera.plane_distance_m : camera.eye_distance_m;
  return glm::dvec3(0, 0, ahead_m) + options.light_distance_m * light_direction(options);
}

glm::dvec3 light_direction_in_probe(const ShadingOptions& options, const Camera& camera) {
  const glm::dvec3 d = light_direction(options);
  return d.x * camera.right + d.y * camera.down + d.z * camera.forward;
}

glm::dvec3 light_position_in_probe_m(const ShadingOptions& options, const Camera& camera) {
  return camera.center + options.light_distance_m * light_direction_in_probe(options, camera);
}

}  // namespace wobblebench::render
