// The line along which one stick is acquired.
#pragma once

#include <glm/vec3.hpp>

#include "hw/probe/acquisition_plan.h"
#include "hw/probe/probe.h"

namespace wobblebench::sim {

/// Ray and time of one stick.
struct TimedRay {
  hw::Ray ray;        ///< probe frame, from the face
  double time_s = 0;  ///< device time of the stick, which decides where moving tissue is
};

/// Ray and time of a stick. `geometry`: the plan's, for those who ask for many sticks.
TimedRay stick_ray(const hw::AcquisitionPlan& plan, const hw::StickIndex& index);
TimedRay stick_ray(const hw::AcquisitionPlan& plan,
                   const hw::ProbeGeometry& geometry,
                   const hw::StickIndex& index);

/// Unit vectors across a stick: in the image plane towards greater theta, and across the image
/// plane towards greater phi.
struct AcrossStick {
  glm::dvec3 lateral;
  glm::dvec3 elevation;
};
AcrossStick across_stick(const hw::Ray& ray);
/// Angle of the stick in its image plane.
double stick_angle_rad(const hw::Ray& ray);

}  // namespace wobblebench::sim
