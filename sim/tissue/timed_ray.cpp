#include "sim/tissue/timed_ray.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>

namespace wobblebench::sim {

TimedRay stick_ray(const hw::AcquisitionPlan& plan, const hw::StickIndex& index) {
  return stick_ray(plan, plan.geometry(), index);
}

TimedRay stick_ray(const hw::AcquisitionPlan& plan,
                   const hw::ProbeGeometry& geometry,
                   const hw::StickIndex& index) {
  const auto time = plan.stick_time(plan.sequence(index)).time_since_epoch();
  return {geometry.stick(plan.theta_rad(static_cast<int>(index.line)), plan.motor_angle_rad(index)),
          std::chrono::duration<double>(time).count()};
}

AcrossStick across_stick(const hw::Ray& ray) {
  // The image plane contains the array, which lies along x.
  const glm::dvec3 elevation = glm::normalize(glm::cross(glm::dvec3(1, 0, 0), ray.direction));
  return {glm::cross(ray.direction, elevation), elevation};
}

double stick_angle_rad(const hw::Ray& ray) {
  return std::asin(std::clamp(ray.direction.x, -1.0, 1.0));
}

}  // namespace wobblebench::sim
