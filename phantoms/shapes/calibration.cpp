// Bodies in fluid whose surfaces have a closed form: plane, sphere, points.
#include "phantoms/shapes/calibration.h"
#include "base/units.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "phantoms/builders.h"
#include "phantoms/shapes/level_set.h"
#include "phantoms/shapes/shapes.h"

namespace wobblebench::phantoms {

Phantom make_plane(const PhantomOptions& options) {
  // Wider than the field of the default probe at every allowed tilt.
  const glm::dvec3 half{120 * kMillimetre, 120 * kMillimetre, 20 * kMillimetre};
  const glm::dmat3 turn = rotation_xyz({options.tilt_x_rad, options.tilt_y_rad, 0});
  const auto distance = [=](const glm::dvec3& position) {
    return box_distance(position * turn - glm::dvec3(0, 0, half.z), half);
  };
  auto grid = build_level_set(
      "slab", distance, cube(glm::length(half) + 2 * half.z), options.voxel_m, Distances::exact);
  return Phantom("plane",
                 material_table(),
                 material_index("amniotic_fluid"),
                 {{"slab", material_index("soft_tissue"), true}},
                 box_from(-kBoxDepth_m / 2, 35 * kMillimetre),
                 kCalibrationPosition,
                 single_grid(grid));
}

Phantom make_sphere(const PhantomOptions& options) {
  const double radius = options.radius_m;
  const auto distance = [=](const glm::dvec3& position) { return glm::length(position) - radius; };
  auto grid = build_level_set("ball",
                              distance,
                              cube(radius + 2 * kHalfWidthVoxels * options.voxel_m),
                              options.voxel_m,
                              Distances::exact);
  // At least 40 mm of fluid between the ball and the probe, at every allowed radius.
  const glm::dvec3 position{0, 0, std::max(kCalibrationPosition.z, radius + 80 * kMillimetre)};
  return Phantom("sphere",
                 material_table(),
                 material_index("amniotic_fluid"),
                 {{"ball", material_index("soft_tissue"), true}},
                 box_from(-radius - 10 * kMillimetre,
                          std::clamp(1.5 * radius, 30 * kMillimetre, 40 * kMillimetre)),
                 position,
                 single_grid(grid));
}

}  // namespace wobblebench::phantoms
