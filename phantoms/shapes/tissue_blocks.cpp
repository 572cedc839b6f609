// Phantoms that are tissue everywhere, with or without something in it.
#include <algorithm>
#include <glm/geometric.hpp>

#include "base/units.h"
#include "phantoms/shapes/builders.h"
#include "phantoms/shapes/calibration.h"
#include "phantoms/shapes/level_set.h"
#include "phantoms/shapes/shapes.h"

namespace wobblebench::phantoms {
namespace {}  // namespace

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
                 only(grid));
}

Phantom make_cyst(const PhantomOptions& options) {
  const double radius = options.radius_m;
  const auto distance = [=](const glm::dvec3& position) { return glm::length(position) - radius; };
  auto grid = build_level_set("cyst",
                              distance,
                              cube(radius + 2 * kHalfWidthVoxels * options.voxel_m),
                              options.voxel_m,
                              Distances::exact);
  // The picture starts in the fluid and shows the back wall: the front of its box is a square
  // within the cyst's largest circle.
  const double half = 0.65 * radius;
  // 30 mm of tissue before it, and what lies behind a cyst of the default size above the noise.
  return Phantom("cyst",
                 material_table(),
                 material_index("soft_tissue"),
                 {{"cyst", material_index("amniotic_fluid"), true}},
                 box_from(0, half),
                 {0, 0, radius + 70 * kMillimetre},
                 only(grid));
}

Phantom make_bone_plate(const PhantomOptions& options) {
  // Narrower than the field, so that tissue in its shadow lies beside tissue that is not.
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
  // Its front 40 mm below the face: the shadow of a plate of the default thickness stays above the
  // noise for some 30 mm behind it.
  return Phantom("bone_plate",
                 material_table(),
                 material_index("soft_tissue"),
                 {{"plate", material_index("cortical_bone"), false}},
                 box_from(-15 * kMillimetre, 35 * kMillimetre),
                 {0, 0, 80 * kMillimetre},
                 only(grid));
}

}  // namespace wobblebench::phantoms
