#include "sim/tissue/timed_ray.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace wobblebench::sim {

AcrossStick across_stick(const hw::Ray& ray) {
  // The image plane contains the array, which lies along x.
  const glm::dvec3 elevation = glm::normalize(glm::cross(glm::dvec3(1, 0, 0), ray.direction));
  return {glm::cross(ray.direction, elevation), elevation};
}

double stick_angle_rad(const hw::Ray& ray) {
  return std::asin(std::clamp(ray.direction.x, -1.0, 1.0));
}

}  // namespace wobblebench::sim
