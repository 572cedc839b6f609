// Phantoms whose field is filled with tissue: speckle block, cyst, bone plate.
#include <algorithm>
#include <glm/geometric.hpp>

#include "base/units.h"
#include "phantoms/builders.h"
#include "phantoms/shapes/calibration.h"
#include "phantoms/shapes/level_set.h"
#include "phantoms/shapes/shapes.h"

namespace wobblebench::phantoms {

Phantom make_speckle_block(const PhantomOptions& options) {
  const glm::dvec3 half{150 * kMillimetre, 150 * kMillimetre, 120 * kMillimetre};
  const auto distance = [=](const glm::dvec3& position) { return box_distance(position, half); };
  auto grid = build_level_set(
      "block", distance, cube(160 * kMillimetre), options.voxel_m, Distances::exact);
  return Phantom("speckle_block",
                 material_table(),
                 material_index("soft_tissue"),
                 {{"block", material_index("soft_tissue"), false}},
                 cube(35 * kMillimetre),
                 kCalibrationPosition,
                 single_grid(grid));
}

Phantom make_cyst(const PhantomOptions& options) {
  const double radius = options.radius_m;
  const auto distance = [=](const glm::dvec3& position) { return glm::length(position) - radius; };
  auto grid = build_level_set("cyst",
                              distance,
                              cube(radius + 2 * kHalfWidthVoxels * options.voxel_m),
                              options.voxel_m,
                              Distances::exact);
  // The region of interest starts in the fluid and contains the back wall: its front face is a
  // square within the cyst's equator.
  const double half = 0.65 * radius;
  // 30 mm of tissue in front of it; echoes from behind a cyst of the default size are above the
  // noise.
  return Phantom("cyst",
                 material_table(),
                 material_index("soft_tissue"),
                 {{"cyst", material_index("amniotic_fluid"), true}},
                 box_from(0, half),
                 {0, 0, radius + 70 * kMillimetre},
                 single_grid(grid));
}

Phantom make_bone_plate(const PhantomOptions& options) {
  // Narrower than the field, so that shadowed tissue lies beside insonified tissue.
  const glm::dvec3 half{15 * kMillimetre, 15 * kMillimetre, options.thickness_m / 2};
  const glm::dmat3 turn = rotation_xyz({options.tilt_x_rad, options.tilt_y_rad, 0});
  const auto distance = [=](const glm::dvec3& position) {
    return box_distance(position * turn - glm::dvec3(0, 0, half.z), half);
  };
  auto grid = build_level_set("plate",
                              distance,
                              cube(glm::length(half) + options.thickness_m),
                              options.voxel_m,
                              Distances::exact);
  // Its front 40 mm below the probe's face: behind a plate of the default thickness the echoes are
  // above the noise for some 30 mm.
  return Phantom("bone_plate",
                 material_table(),
                 material_index("soft_tissue"),
                 {{"plate", material_index("cortical_bone"), false}},
                 box_from(-15 * kMillimetre, 35 * kMillimetre),
                 {0, 0, 80 * kMillimetre},
                 single_grid(grid));
}

}  // namespace wobblebench::phantoms
