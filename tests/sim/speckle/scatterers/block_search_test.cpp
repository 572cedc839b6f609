// The blocks that a stick's beam touches, against positions in the beam that are mapped back to
// tissue at rest.
#include "sim/speckle/scatterers/block_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <random>
#include <set>
#include <tuple>

#include "base/units.h"
#include "phantoms/phantom.h"
#include "sim/tissue/scanned_tissue.h"
#include "sim/tissue/tissue_map.h"

namespace wobblebench::sim {
namespace {

using Turn = phantoms::Deformation::Turn;

constexpr double kEnd_m = 0.15;
const BlockGrid kGrid{{-0.12, -0.12, 0}, 8e-3, {0, 0, 0}, {29, 29, 24}};

struct Search {
  explicit Search(const phantoms::Motion& motion) {
    static const auto phantom = phantoms::make_phantom({.name = "speckle_block", .voxel_m = 2e-3});
    static const auto map = std::make_shared<const TissueMap>(phantom, 2e-3, 0);
    tissue = {map, phantom.materials(), {}, motion};
  }

  std::vector<TouchedBlock> find(const TimedRay& line) const {
    const double margin_m = 0.5 * std::sqrt(3.0) * kGrid.side_m;
    const BeamBounds bounds(beam, lateral(line), kEnd_m, margin_m);
    std::vector<TouchedBlock> touched;
    find_touched_blocks(StickTransform(tissue, line), bounds, kGrid, kEnd_m, touched);
    return touched;
  }

  const BeamTable::Direction& lateral(const TimedRay& line) const {
    return beam.lateral()[beam.lateral_of(stick_angle_rad(line.ray))];
  }

  hw::AcquisitionPlan plan{{}, {}};
  BeamTable beam{ProbeOptics(plan), BeamShape::main_lobe};
  ScannedTissue tissue;
};

using Index = std::tuple<int, int, int>;
Index index_of(const glm::ivec3& index) {
  return {index.x, index.y, index.z};
}

/// A position in the beam, in beam coordinates.
glm::dvec3 position_in_beam(const Search& search, const TimedRay& line, std::mt19937& random) {
  std::uniform_real_distribution<double> range_m(0, kEnd_m), angle_rad(0, 2 * kPi), share(0, 1);
  const double x = range_m(random), angle = angle_rad(random), radius = std::sqrt(share(random));
  const BeamTable& beam = search.beam;
  const int row = beam.row(x);
  return {x,
          radius * std::cos(angle) * beam.reach_m(search.lateral(line), row),
          radius * std::sin(angle) * beam.reach_m(beam.elevation(), row)};
}

class BlockSearch : public ::testing::TestWithParam<phantoms::MotionOptions> {
 protected:
  BlockSearch() : search_(phantoms::Motion(GetParam(), kJoint)) {}

  static constexpr phantoms::Joint kJoint{{0, 0, 0.08}, 20e-3, 50e-3, {}};
  Search search_;
  std::mt19937 random_{3};
};

TEST_P(BlockSearch, FindsTheBlockOfEveryPositionInTheBeamOnce) {
  std::size_t positions = 0;
  for (const hw::StickIndex index : {hw::StickIndex{1, 18, 32}, {2, 2, 60}, {3, 30, 8}}) {
    const TimedRay line = stick_ray(search_.plan, index);
    const StickTransform transform(search_.tissue, line);
    const auto touched = search_.find(line);
    std::set<Index> found;
    for (const TouchedBlock& block : touched) {
      EXPECT_TRUE(found.insert(index_of(block.index)).second);
    }
    std::set<Index> needed;
    for (int i = 0; i < 20000; ++i) {
      const glm::dvec3 rest = transform.to_rest(position_in_beam(search_, line, random_));
      const glm::ivec3 block(glm::floor((rest - kGrid.origin_m) / kGrid.side_m));
      if (glm::clamp(block, kGrid.first, kGrid.last) != block) continue;
      ++positions;
      needed.insert(index_of(block));
      EXPECT_TRUE(found.contains(index_of(block))) << rest.x << " " << rest.y << " " << rest.z;
    }
    EXPECT_LT(found.size(), 3 * needed.size());
  }
  EXPECT_GT(positions, 30000u);
}

TEST_P(BlockSearch, TellsHowABlockMoves) {
  int rigid = 0;
  const TimedRay line = stick_ray(search_.plan, {2, 10, 20});
  const StickTransform transform(search_.tissue, line);
  for (const TouchedBlock& block : search_.find(line)) {
    EXPECT_LT(glm::distance(block.center, transform.to_beam(kGrid.center(block.index))), 1e-9);
    if (block.turn == Turn::partial) continue;
    ++rigid;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 side(corner & 1, corner >> 1 & 1, corner >> 2);
      const glm::dvec3 rest = kGrid.origin_m + kGrid.side_m * (glm::dvec3(block.index) + side);
      EXPECT_LT(glm::distance(transform.rigid_map(block.turn)(rest), transform.to_beam(rest)),
                1e-9);
    }
  }
  EXPECT_GT(rigid, 5);
}

INSTANTIATE_TEST_SUITE_P(
    Motions,
    BlockSearch,
    ::testing::Values(phantoms::MotionOptions{},
                      phantoms::MotionOptions{.velocity_m_s = {0.01, 0, 0.005},
                                              .turn_rate_rad_s = {0.1, 0.2, 0.3}},
                      phantoms::MotionOptions{.head_turn_rad = 20 * kDegree},
                      phantoms::MotionOptions{.turn_rate_rad_s = {0, 0, 0.2},
                                              .head_turn_rad = 40 * kDegree,
                                              .head_axis = phantoms::HeadAxis::nod}));

}  // namespace
}  // namespace wobblebench::sim
