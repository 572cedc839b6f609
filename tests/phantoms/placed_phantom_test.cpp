#include "phantoms/placed_phantom.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "phantoms/grids.h"

namespace wobblebench::phantoms {
namespace {

Phantom empty_phantom() {
  return {"empty",
          material_table(),
          material_index("soft_tissue"),
          {},
          {glm::dvec3(-1), glm::dvec3(1)},
          glm::dvec3(0),
          std::make_shared<Grids>()};
}

TEST(PlacedPhantom, StillAtAPositionIsAShift) {
  const PlacedPhantom subject = still_at(empty_phantom(), {1e-3, 2e-3, 0.1});
  EXPECT_TRUE(subject.motion.still());
  EXPECT_EQ(subject.from_rest({0, 0, 0}, 7), glm::dvec3(1e-3, 2e-3, 0.1));
  EXPECT_EQ(subject.to_rest({1e-3, 2e-3, 0.1}, 7), glm::dvec3(0));
}

TEST(PlacedPhantom, MovesInItsOwnFrameAndThenIsPlaced) {
  PlacedPhantom subject = still_at(empty_phantom(), {0, 0, 0.1});
  subject.placement.rotation = rotation_xyz({0, 0, 90 * kDegree});  // x to y
  subject.motion = Motion({.velocity_m_s = {10e-3, 0, 0}}, std::nullopt);
  const glm::dvec3 moved = subject.from_rest({0, 0, 0}, 0.5);
  EXPECT_LT(glm::distance(moved, glm::dvec3(0, 5e-3, 0.1)), 1e-15);
  EXPECT_LT(glm::length(subject.to_rest(moved, 0.5)), 1e-15);
}

TEST(PlacedPhantom, CopiesShareTheGrids) {
  const PlacedPhantom subject = still_at(empty_phantom(), {0, 0, 0.1});
  const PlacedPhantom copy = subject;
  EXPECT_EQ(&copy.phantom.grids(), &subject.phantom.grids());
}

}  // namespace
}  // namespace wobblebench::phantoms
