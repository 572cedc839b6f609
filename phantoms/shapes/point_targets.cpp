#include <cmath>

#include "base/units.h"
#include "phantoms/builders.h"
#include "phantoms/grids.h"

namespace wobblebench::phantoms {
namespace {

// Of the default probe: radius of its face, and how far before the centre of curvature the motor's
// axis lies.
constexpr double kFaceRadius_m = 40e-3, kMotorAxis_m = 13e-3;

/// docs/units.md, from the middle of the face.
glm::dvec3 position_of(const PointTarget& target) {
  const double r = kFaceRadius_m + target.range_m;
  const double from_axis = r * std::cos(target.theta_rad) - kMotorAxis_m;
  return {r * std::sin(target.theta_rad),
          -from_axis * std::sin(target.phi_rad),
          kMotorAxis_m + from_axis * std::cos(target.phi_rad) - kFaceRadius_m};
}

}  // namespace

std::vector<PointTarget> point_targets() {
  std::vector<PointTarget> targets;
  for (int range_mm = 20; range_mm <= 150; range_mm += 10) {
    targets.push_back({range_mm * kMillimetre, 0, 0});
  }
  for (const double range_m : {50e-3, 100e-3, 150e-3}) {
    for (const double angle_deg : {-30.0, -20.0, -10.0, 10.0, 20.0, 30.0}) {
      targets.push_back({range_m, angle_deg * kDegree, 0});
      if (std::abs(angle_deg) < 30) targets.push_back({range_m, 0, angle_deg * kDegree});
    }
  }
  return targets;
}

Phantom make_points(const PhantomOptions& options) {
  PointScatterers points;
  const double echo = std::pow(10.0, options.point_echo_db / 20);
  for (const PointTarget& target : point_targets()) points.add({position_of(target), echo});
  return Phantom("points",
                 material_table(),
                 material_index(options.background),
                 {},
                 {{-100e-3, -70e-3, 10e-3}, {100e-3, 70e-3, 155e-3}},
                 {0, 0, kFaceRadius_m},
                 std::make_shared<const Grids>(),
                 std::nullopt,
                 points);
}

}  // namespace wobblebench::phantoms
