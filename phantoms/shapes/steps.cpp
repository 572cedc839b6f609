// The steps phantom: a staircase of known heights.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <numeric>

#include "base/units.h"
#include "phantoms/builders.h"
#include "phantoms/shapes/calibration.h"
#include "phantoms/shapes/level_set.h"

namespace wobblebench::phantoms {
namespace {

constexpr double kBack_m = 20 * kMillimetre;        // z of the body's back
constexpr double kHalfWidth_m = 120 * kMillimetre;  // wider than the field of the default probe

using Polygon = std::vector<glm::dvec2>;

// The cross section of the body in the xz plane: the back, then the treads from left to right.
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

}  // namespace

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
  auto grid = build_level_set("stairs", distance, bounds, options.voxel_m, Distances::exact);
  // At least 40 mm of fluid between the stairs and the probe, at every allowed height.
  const glm::dvec3 position{0, 0, std::max(kCalibrationPosition.z, total + 80 * kMillimetre)};
  return Phantom("steps",
                 material_table(),
                 material_index("amniotic_fluid"),
                 {{"stairs", material_index("soft_tissue"), true}},
                 box_from(-total - 10 * kMillimetre, 35 * kMillimetre),
                 position,
                 single_grid(grid));
}

}  // namespace wobblebench::phantoms
