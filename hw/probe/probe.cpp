#include "hw/probe/probe.h"

#include <array>
#include <cmath>
#include <cstddef>

#include "base/options.h"
#include "hw/probe/beam_width.h"

namespace wobblebench::hw {

void validate(const ProbeOptions& options) {
  check_options(options);
}

ProbeGeometry::ProbeGeometry(const ProbeOptions& options)
    : a_(options.radius_m), b_(options.radius_m - options.wobble_radius_m) {
  validate_known(options);
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

namespace {

/// Angle between the centres of the first and the last element at the centre of curvature.
double sector_of_elements_rad(const ProbeOptions& probe) {
  return (probe.elements - 1) * probe.pitch_m / probe.radius_m;
}

ProbePresetData standard() {
  return {"sector: the paper (docs/references.md [1]); assumed: all others (docs/decisions/0006)",
          {},
          77 * kDegree};
}

ProbePresetData c5_2v() {
  ProbeOptions probe;
  probe.radius_m = 49.57e-3;
  probe.center_frequency_hz = 3.57e6;
  probe.fractional_bandwidth = 0.79;
  probe.elements = 128;
  probe.pitch_m = 0.508e-3;
  probe.element_height_m = 13.5e-3;
  probe.elevation_focus_m = 60e-3;
  return {
      "Verasonics C5-2v in getparam of the MUST toolbox (docs/references.md [14]); sector: what "
      "its elements span; "
      "assumed: that it wobbles, wobble radius, F-number, transmit focus (the defaults)",
      probe,
      sector_of_elements_rad(probe)};
}

ProbePresetData curvilinear_60() {
  ProbeOptions probe;
  probe.radius_m = 60e-3;
  probe.center_frequency_hz = 3.0e6;
  probe.fractional_bandwidth = 1.0;
  probe.elements = 128;
  probe.pitch_m = 0.477e-3;
  probe.element_height_m = 14e-3;
  probe.elevation_focus_m = 50e-3;
  return {
      "curvilinear probe of the RSNA QIBA shear-wave digital phantoms (docs/references.md [15]); "
      "sector: what its "
      "elements span; assumed: number of elements, that it wobbles, wobble radius, F-number, "
      "transmit focus (the defaults)",
      probe,
      sector_of_elements_rad(probe)};
}

}  // namespace

const ProbePresetData& probe_preset(ProbePreset preset) {
  static const std::array<ProbePresetData, 3> presets = {standard(), c5_2v(), curvilinear_60()};
  return presets.at(static_cast<std::size_t>(preset));
}

}  // namespace wobblebench::hw
