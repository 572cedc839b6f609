#include "hw/probe/probe.h"

#include <cmath>
#include <sstream>

#include "base/options.h"

namespace wobblebench::hw {

void validate(const ProbeOptions& options) {
  check_options(options);
  if (options.wobble_radius_m <= options.radius_m) return;
  std::ostringstream shown, allowed;
  shown << options.wobble_radius_m / kMillimetre;
  allowed << "must not exceed radius_mm = " << options.radius_m / kMillimetre;
  throw InvalidOption("wobble_radius_mm", shown.str(), allowed.str());
}

ProbeGeometry::ProbeGeometry(const ProbeOptions& options)
    : a_(options.radius_m), b_(options.radius_m - options.wobble_radius_m) {
  validate(options);
}

glm::dvec3 ProbeGeometry::to_cartesian(const PolarPoint& point) const {
  const double r = a_ + point.range_m;
  // Signed, in the image plane from the wobble axis; negative behind it.
  const double axis_distance = r * std::cos(point.theta_rad) - b_;
  return {r * std::sin(point.theta_rad),
          -axis_distance * std::sin(point.phi_rad),
          b_ + axis_distance * std::cos(point.phi_rad)};
}

PolarPoint ProbeGeometry::to_polar(const glm::dvec3& position_m) const {
  const double height = position_m.z - b_;
  // cos(phi) > 0, so the sign of the height above the axis is the sign of the distance.
  const double side = height < 0 ? -1.0 : 1.0;
  const double axis_distance = side * std::hypot(position_m.y, height);
  const double depth = b_ + axis_distance;  // r cos(theta)
  const double phi = axis_distance == 0 ? 0.0 : std::atan2(-side * position_m.y, side * height);
  return {std::hypot(position_m.x, depth) - a_, std::atan2(position_m.x, depth), phi};
}

Ray ProbeGeometry::stick(double theta_rad, double phi_rad) const {
  const double cos_theta = std::cos(theta_rad);
  return {to_cartesian({0, theta_rad, phi_rad}),
          {std::sin(theta_rad), -cos_theta * std::sin(phi_rad), cos_theta * std::cos(phi_rad)}};
}

}  // namespace wobblebench::hw
