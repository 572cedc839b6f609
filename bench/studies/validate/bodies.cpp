#include "bench/studies/validate/bodies.h"

#include <algorithm>

#include "phantoms/grids.h"
#include "phantoms/shapes/level_set.h"
#include "phantoms/shapes/shapes.h"

namespace wobblebench::bench {

phantoms::Phantom open_tissue(const std::string& material) {
  return {"open_tissue",
          phantoms::material_table(),
          phantoms::material_index(material),
          {},
          {glm::dvec3(-1), glm::dvec3(1)},
          glm::dvec3(0),
          std::make_shared<phantoms::Grids>()};
}

phantoms::Phantom block(const glm::dvec3& half_m, double voxel_m) {
  const double reach_m = std::max({half_m.x, half_m.y, half_m.z});
  const double room = reach_m + 2 * phantoms::kHalfWidthVoxels * voxel_m;
  auto grids = std::make_shared<phantoms::Grids>();
  grids->signed_distance = {phantoms::build_level_set(
      "block",
      [=](const glm::dvec3& p) { return phantoms::box_distance(p, half_m); },
      {glm::dvec3(-room), glm::dvec3(room)},
      voxel_m,
      phantoms::Distances::exact)};
  return {"block",
          phantoms::material_table(),
          phantoms::material_index("amniotic_fluid"),
          {{"block", phantoms::material_index("soft_tissue"), true}},
          {glm::dvec3(-reach_m), glm::dvec3(reach_m)},
          glm::dvec3(0),
          grids};
}

}  // namespace wobblebench::bench
