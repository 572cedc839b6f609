// Phantoms of simple bodies for calibration: in fluid, in tissue that fills the field, points
// alone.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "base/units.h"
#include "phantoms/builders.h"
#include "phantoms/framing.h"
#include "phantoms/grids.h"
#include "phantoms/shapes/level_set.h"
#include "phantoms/shapes/shapes.h"

namespace wobblebench::phantoms {
namespace {

// 70 mm below the face of the default probe, whose centre of curvature is 40 mm behind its face.
constexpr glm::dvec3 kCalibrationPosition{0, 0, 110e-3};

Box cube(double half_m) {
  return {glm::dvec3(-half_m), glm::dvec3(half_m)};
}

// A region of interest of kBoxDepth_m about the z axis, its front at z = `front_m`.
Box box_from(double front_m, double half_width_m) {
  return {{-half_width_m, -half_width_m, front_m},
          {half_width_m, half_width_m, front_m + kBoxDepth_m}};
}

struct Body {
  std::string name;
  std::string inside;  // material
  bool is_target;
  DistanceFunction distance;  // exact
  Box bounds;
};

// The phantom of one body in another material.
Phantom phantom_of(const PhantomOptions& options,
                   const Body& body,
                   const std::string& background,
                   const Box& region_of_interest,
                   const glm::dvec3& position_m) {
  return Phantom(options.name,
                 material_table(),
                 material_index(background),
                 {{body.name, material_index(body.inside), body.is_target}},
                 region_of_interest,
                 position_m,
                 single_grid(build_level_set(
                     body.name, body.distance, body.bounds, options.voxel_m, Distances::exact)));
}

// A ball about the origin.
Body ball_of(const PhantomOptions& options, const std::string& name, const std::string& inside) {
  const double radius = options.radius_m;
  return {name,
          inside,
          true,
          [=](const glm::dvec3& position) { return glm::length(position) - radius; },
          cube(radius + 2 * kHalfWidthVoxels * options.voxel_m)};
}

// Signed distance to a box of these half sizes whose front face goes through the origin, tilted.
DistanceFunction tilted_box(const PhantomOptions& options, const glm::dvec3& half) {
  const glm::dmat3 turn = rotation_xyz({options.tilt_x_rad, options.tilt_y_rad, 0});
  return [=](const glm::dvec3& position) {
    return box_distance(position * turn - glm::dvec3(0, 0, half.z), half);
  };
}

constexpr double kBack_m = 20 * kMillimetre;        // z of the back of the stairs
constexpr double kHalfWidth_m = 120 * kMillimetre;  // wider than the field of the default probe

using Polygon = std::vector<glm::dvec2>;

// The cross section of the stairs in the xz plane: the back, then the treads from left to right.
Polygon profile(const std::vector<double>& heights_m) {
  const double treads = double(heights_m.size()) + 1;
  Polygon corners = {{kHalfWidth_m, kBack_m}, {-kHalfWidth_m, kBack_m}, {-kHalfWidth_m, 0}};
  double height = 0;
  for (std::size_t k = 0; k < heights_m.size(); ++k) {
    const double x = kStairs_m * (double(k + 1) / treads - 0.5);
    corners.push_back({x, -height});
    height += heights_m[k];
    corners.push_back({x, -height});
  }
  corners.push_back({kHalfWidth_m, -height});
  return corners;
}

// Exact signed distance, negative inside; the sign by the parity of crossings along +x.
double polygon_distance(const Polygon& corners, const glm::dvec2& p) {
  double nearest2 = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec2 a = corners[i], b = corners[(i + 1) % corners.size()];
    const glm::dvec2 edge = b - a, arm = p - a;
    const double along = std::clamp(glm::dot(arm, edge) / glm::dot(edge, edge), 0.0, 1.0);
    const glm::dvec2 gap = arm - along * edge;
    nearest2 = std::min(nearest2, glm::dot(gap, gap));
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) {
      inside = !inside;
    }
  }
  return inside ? -std::sqrt(nearest2) : std::sqrt(nearest2);
}

// The default probe's radius of its face, and distance from the centre of curvature to the motor's
// axis.
constexpr double kFaceRadius_m = 40e-3, kMotorAxis_m = 13e-3;

// As docs/units.md has it, from the middle of the face.
glm::dvec3 position_of(const PointTarget& target) {
  const double r = kFaceRadius_m + target.range_m;
  const double from_axis = r * std::cos(target.theta_rad) - kMotorAxis_m;
  return {r * std::sin(target.theta_rad),
          -from_axis * std::sin(target.phi_rad),
          kMotorAxis_m + from_axis * std::cos(target.phi_rad) - kFaceRadius_m};
}

}  // namespace

Phantom make_plane(const PhantomOptions& options) {
  // Wider than the field of the default probe at every allowed tilt.
  const glm::dvec3 half{120 * kMillimetre, 120 * kMillimetre, 20 * kMillimetre};
  return phantom_of(options,
                    {"slab",
                     "soft_tissue",
                     true,
                     tilted_box(options, half),
                     cube(glm::length(half) + 2 * half.z)},
                    "amniotic_fluid",
                    box_from(-kBoxDepth_m / 2, 35 * kMillimetre),
                    kCalibrationPosition);
}

Phantom make_sphere(const PhantomOptions& options) {
  const double radius = options.radius_m;
  // At least 40 mm of fluid between the ball and the probe, at every allowed radius.
  return phantom_of(options,
                    ball_of(options, "ball", "soft_tissue"),
                    "amniotic_fluid",
                    box_from(-radius - 10 * kMillimetre,
                             std::clamp(1.5 * radius, 30 * kMillimetre, 40 * kMillimetre)),
                    {0, 0, std::max(kCalibrationPosition.z, radius + 80 * kMillimetre)});
}

Phantom make_steps(const PhantomOptions& options) {
  const Polygon corners = profile(options.step_heights_m);
  const double total =
      std::accumulate(options.step_heights_m.begin(), options.step_heights_m.end(), 0.0);
  const auto distance = [&](const glm::dvec3& p) {
    // The profile extruded along y.
    const glm::dvec2 outside{polygon_distance(corners, {p.x, p.z}), std::abs(p.y) - kHalfWidth_m};
    return glm::length(glm::max(outside, 0.0)) + std::min(std::max(outside.x, outside.y), 0.0);
  };
  const double margin = 2 * kHalfWidthVoxels * options.voxel_m;
  const glm::dvec3 half{kHalfWidth_m, kHalfWidth_m, 0};
  const Box bounds{-half - glm::dvec3(margin) - glm::dvec3(0, 0, total),
                   half + glm::dvec3(margin) + glm::dvec3(0, 0, kBack_m)};
  // At least 40 mm of fluid between the stairs and the probe, at every allowed height.
  return phantom_of(options,
                    {"stairs", "soft_tissue", true, distance, bounds},
                    "amniotic_fluid",
                    box_from(-total - 10 * kMillimetre, 35 * kMillimetre),
                    {0, 0, std::max(kCalibrationPosition.z, total + 80 * kMillimetre)});
}

Phantom make_speckle_block(const PhantomOptions& options) {
  const glm::dvec3 half{150 * kMillimetre, 150 * kMillimetre, 120 * kMillimetre};
  const auto distance = [=](const glm::dvec3& position) { return box_distance(position, half); };
  return phantom_of(options,
                    {"block", "soft_tissue", false, distance, cube(160 * kMillimetre)},
                    "soft_tissue",
                    cube(35 * kMillimetre),
                    kCalibrationPosition);
}

Phantom make_cyst(const PhantomOptions& options) {
  const double radius = options.radius_m;
  // The region of interest starts in the fluid and contains the back wall: its front face is a
  // square within the cyst's equator. 30 mm of tissue lie in front of the cyst; echoes from behind
  // one of the default size are above the noise.
  return phantom_of(options,
                    ball_of(options, "cyst", "amniotic_fluid"),
                    "soft_tissue",
                    box_from(0, 0.65 * radius),
                    {0, 0, radius + 70 * kMillimetre});
}

Phantom make_bone_plate(const PhantomOptions& options) {
  // Narrower than the field, so that shadowed tissue lies beside insonified tissue. Its front lies
  // 40 mm below the probe's face: behind a plate of the default thickness the echoes are above the
  // noise for some 30 mm.
  const glm::dvec3 half{15 * kMillimetre, 15 * kMillimetre, options.thickness_m / 2};
  return phantom_of(options,
                    {"plate",
                     "cortical_bone",
                     false,
                     tilted_box(options, half),
                     cube(glm::length(half) + options.thickness_m)},
                    "soft_tissue",
                    box_from(-15 * kMillimetre, 35 * kMillimetre),
                    {0, 0, 80 * kMillimetre});
}

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
