// Search for the blocks of tissue that a stick's beam touches.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "phantoms/motion.h"
#include "sim/optics/beam_table.h"

namespace wobblebench::sim {

class StickTransform;

/// A uniform grid of blocks at rest.
struct BlockGrid {
  glm::dvec3 origin_m{0};
  double side_m = 0;
  glm::ivec3 first{0};  ///< blocks outside `first` to `last` are never touched
  glm::ivec3 last{0};

  glm::dvec3 center(const glm::ivec3& index) const {
    return origin_m + side_m * (glm::dvec3(index) + 0.5);
  }
};

struct TouchedBlock {
  glm::ivec3 index{0};
  glm::dvec3 center{0};  ///< beam coordinates
  phantoms::Deformation::Turn turn = phantoms::Deformation::Turn::none;
};

/// Finds the blocks that touch the beam up to range `end_m`, each once, in an order that depends on
/// the transform alone. Overwrites `touched`.
void find_touched_blocks(const StickTransform& transform,
                         const BeamBounds& bounds,
                         const BlockGrid& grid,
                         double end_m,
                         std::vector<TouchedBlock>& touched);

}  // namespace wobblebench::sim
