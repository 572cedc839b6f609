#include "sim/tissue/scanned_tissue.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/duration.h"

namespace wobblebench::sim {

TimedRay stick_ray(const hw::AcquisitionPlan& plan, const hw::StickIndex& index) {
  return stick_ray(plan, plan.geometry(), index);
}

TimedRay stick_ray(const hw::AcquisitionPlan& plan,
                   const hw::ProbeGeometry& geometry,
                   const hw::StickIndex& index) {
  const auto time = plan.stick_time(plan.sequence(index)).time_since_epoch();
  return {geometry.stick(plan.theta_rad(static_cast<int>(index.line)), plan.motor_angle_rad(index)),
          to_seconds(time)};
}

AcrossStick across_stick(const hw::Ray& ray) {
  // The image plane contains the array, which lies along x.
  const glm::dvec3 elevation = glm::normalize(glm::cross(glm::dvec3(1, 0, 0), ray.direction));
  return {glm::cross(ray.direction, elevation), elevation};
}

double stick_angle_rad(const hw::Ray& ray) {
  return std::asin(std::clamp(ray.direction.x, -1.0, 1.0));
}

StickTransform::StickTransform(const ScannedTissue& tissue, const TimedRay& line)
    : tissue_(tissue),
      ray_(line.ray),
      across_(across_stick(line.ray)),
      moment_(tissue.motion.at(line.time_s)),
      rigid_(tissue.motion.rigid()) {
  for (const auto turn : {phantoms::Deformation::Turn::none, phantoms::Deformation::Turn::full}) {
    rigid_maps_[static_cast<std::size_t>(turn)] =
        linearised(moment_.tangent_of(turn), glm::dvec3(0));
  }
}

glm::dvec3 StickTransform::to_beam(const glm::dvec3& rest_m) const {
  const glm::dvec3 from_face = tissue_.placement.to_probe(moment_.from_rest(rest_m)) - ray_.origin;
  return {glm::dot(ray_.direction, from_face),
          glm::dot(across_.lateral, from_face),
          glm::dot(across_.elevation, from_face)};
}

glm::dvec3 StickTransform::to_rest(const glm::dvec3& beam_m) const {
  const glm::dvec3 probe_m =
      ray_.at(beam_m.x) + beam_m.y * across_.lateral + beam_m.z * across_.elevation;
  return moment_.to_rest(tissue_.placement.to_phantom(probe_m));
}

RestToBeam StickTransform::linearised(const phantoms::Deformation::Tangent& tangent,
                                      const glm::dvec3& rest_m) const {
  const auto beam = [&](const glm::dvec3& v) {
    return glm::dvec3(
        glm::dot(ray_.direction, v), glm::dot(across_.lateral, v), glm::dot(across_.elevation, v));
  };
  const glm::dvec3 origin = tissue_.placement.to_probe(glm::dvec3(0));
  RestToBeam map;
  for (int axis = 0; axis < 3; ++axis) {
    map.matrix[axis] = beam(tissue_.placement.to_probe(tangent.jacobian[axis]) - origin);
  }
  map.shift =
      beam(tissue_.placement.to_probe(tangent.position_m) - ray_.origin) - map.matrix * rest_m;
  return map;
}

RestToBeam StickTransform::map_near(const glm::dvec3& rest_m) const {
  return linearised(moment_.tangent(rest_m), rest_m);
}

}  // namespace wobblebench::sim
