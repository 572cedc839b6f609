#include "phantoms/shapes/level_set.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetTracker.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "phantoms/float_grid.h"

namespace wobblebench::phantoms {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
using Leaves = std::vector<std::unique_ptr<Leaf>>;

constexpr int kBlock = 64;  // voxels; one parallel task searches one block
constexpr int kLeaf = Leaf::DIM;

// Factor by which first-order shapes may overestimate the distance far from their surface.
constexpr double kOverstatement = 1.3;

// Octree search for the leaves that the band of one surface touches.
class BandSearch {
 public:
  BandSearch(const LocalDistance& distance, double voxel_m, double band_m)
      : distance_(distance), voxel_m_(voxel_m), band_m_(band_m) {}

  void collect(const openvdb::Coord& origin, int size, Leaves& leaves) const {
    collect(origin, size, distance_(ball_around(origin, size)), leaves);
  }

 private:
  /// `distance` is valid within the block.
  void collect(const openvdb::Coord& origin,
               int size,
               const DistanceFunction& distance,
               Leaves& leaves) const {
    if (!may_hold_band(origin, size, distance)) return;
    if (size == kLeaf) {
      if (auto leaf = evaluate(origin, distance_(ball_around(origin, size)))) {
        leaves.push_back(std::move(leaf));
      }
      return;
    }
    const int half = size / 2;
    for (int child = 0; child < 8; ++child) {
      collect(origin.offsetBy(child & 1 ? half : 0, child & 2 ? half : 0, child & 4 ? half : 0),
              half,
              distance,
              leaves);
    }
  }

  /// The smallest ball that contains the block's voxels.
  Ball ball_around(const openvdb::Coord& origin, int size) const {
    const double half = 0.5 * (size - 1);
    return {voxel_m_ * glm::dvec3(origin.x() + half, origin.y() + half, origin.z() + half),
            std::sqrt(3.0) * half * voxel_m_};
  }

  bool may_hold_band(const openvdb::Coord& origin,
                     int size,
                     const DistanceFunction& distance) const {
    const Ball ball = ball_around(origin, size);
    return std::abs(distance(ball.center)) <= kOverstatement * (band_m_ + ball.radius_m);
  }

  std::unique_ptr<Leaf> evaluate(const openvdb::Coord& origin,
                                 const DistanceFunction& distance) const {
    auto leaf = std::make_unique<Leaf>(origin, float(band_m_));
    for (openvdb::Index offset = 0; offset < Leaf::SIZE; ++offset) {
      const openvdb::Coord ijk = leaf->offsetToGlobalCoord(offset);
      const double value = distance(voxel_m_ * glm::dvec3(ijk.x(), ijk.y(), ijk.z()));
      if (std::abs(value) < band_m_) {
        leaf->setValueOn(offset, float(value));
      } else {
        leaf->setValueOff(offset, float(std::copysign(band_m_, value)));
      }
    }
    return leaf->isEmpty() ? nullptr : std::move(leaf);
  }

  const LocalDistance& distance_;
  double voxel_m_;
  double band_m_;
};

std::vector<openvdb::Coord> blocks_of(const Box& bounds, double voxel_m) {
  const auto floor_block = [&](double m) { return int(std::floor(m / voxel_m / kBlock)); };
  std::vector<openvdb::Coord> blocks;
  for (int x = floor_block(bounds.low.x); x <= floor_block(bounds.high.x); ++x) {
    for (int y = floor_block(bounds.low.y); y <= floor_block(bounds.high.y); ++y) {
      for (int z = floor_block(bounds.low.z); z <= floor_block(bounds.high.z); ++z) {
        blocks.emplace_back(x * kBlock, y * kBlock, z * kBlock);
      }
    }
  }
  return blocks;
}

FloatGrid::Ptr evaluate_band(const LocalDistance& distance,
                             const Box& bounds,
                             double voxel_m,
                             double band_m) {
  const std::vector<openvdb::Coord> blocks = blocks_of(bounds, voxel_m);
  std::vector<Leaves> found(blocks.size());
  const BandSearch search(distance, voxel_m, band_m);
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t i) {
    search.collect(blocks[i], kBlock, found[i]);
  });
  auto grid = create_level_set(voxel_m, band_m);
  for (Leaves& leaves : found) {
    for (auto& leaf : leaves) grid->tree().addLeaf(leaf.release());
  }
  openvdb::tools::signedFloodFill(grid->tree());
  return grid;
}

// Voxels this close to the surface get value over gradient as their distance and are then frozen,
// so that solving for the others does not move the surface.
constexpr double kFrozenVoxels = 1.2;

// Value over gradient magnitude: the distance to first order. At creases, where the gradient
// vanishes, the factor is limited to that of a rounded edge.
float first_order_distance(const FloatGrid::ConstAccessor& tree,
                           const openvdb::Coord& at,
                           double voxel_m) {
  double slope2 = 0;
  for (int axis = 0; axis < 3; ++axis) {
    openvdb::Coord low = at, high = at;
    low[axis] -= 1;
    high[axis] += 1;
    const double rise = (tree.getValue(high) - tree.getValue(low)) / (2 * voxel_m);
    slope2 += rise * rise;
  }
  return float(tree.getValue(at) / std::clamp(std::sqrt(slope2), 0.7, 1.5));
}

// Solves the eikonal equation outwards from the surface: a step moves by 0.9 voxel, so six reach
// the rim of the band. First order in space, since the voxels that matter most are frozen.
void renormalise(FloatGrid& grid) {
  using Tracker = openvdb::tools::LevelSetTracker<FloatGrid>;
  const double voxel_m = grid.voxelSize()[0];
  const FloatGrid::Ptr raw = grid.deepCopy();
  Tracker::MaskTreeType moving(grid.tree(), false, openvdb::TopologyCopy());
  openvdb::tree::LeafManager<Tracker::MaskTreeType> masks(moving);
  masks.foreach ([&](Tracker::MaskTreeType::LeafNodeType& mask, std::size_t) {
    const auto tree = raw->getConstAccessor();
    Leaf& leaf = *grid.tree().probeLeaf(mask.origin());
    for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) {
      voxel.setValue(first_order_distance(tree, voxel.getCoord(), voxel_m));
      if (std::abs(*voxel) < kFrozenVoxels * voxel_m) mask.setValueOff(voxel.pos());
    }
  });
  Tracker tracker(grid);
  tracker.setSpatialScheme(openvdb::math::FIRST_BIAS);
  tracker.setTemporalScheme(openvdb::math::TVD_RK2);
  tracker.setNormCount(6);
  tracker.normalize(&moving);
}

void trim(FloatGrid& grid, double band_m) {
  openvdb::tree::LeafManager<openvdb::FloatTree> leaves(grid.tree());
  leaves.foreach ([band_m](Leaf& leaf, std::size_t) {
    for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) {
      if (std::abs(*voxel) < band_m) continue;
      voxel.setValue(float(std::copysign(band_m, *voxel)));
      voxel.setValueOff();
    }
  });
  openvdb::tools::changeLevelSetBackground(grid.tree(), float(band_m));
  openvdb::tools::pruneLevelSet(grid.tree());
}

}  // namespace

FloatGrid::Ptr build_level_set(const std::string& name,
                               const DistanceFunction& distance,
                               const Box& bounds,
                               double voxel_m,
                               Distances distances) {
  // By reference: a copy for each leaf would copy what the function holds.
  const auto same = [&](const Ball&) { return DistanceFunction(std::cref(distance)); };
  return build_level_set(name, LocalDistance(same), bounds, voxel_m, distances);
}

FloatGrid::Ptr build_level_set(const std::string& name,
                               const LocalDistance& distance,
                               const Box& bounds,
                               double voxel_m,
                               Distances distances) {
  initialize_openvdb();
  const double band_m = kHalfWidthVoxels * voxel_m;
  const bool exact = distances == Distances::exact;
  auto grid = evaluate_band(distance, bounds, voxel_m, exact ? band_m : 1.5 * band_m);
  if (!exact) {
    renormalise(*grid);
    trim(*grid, band_m);
  }
  grid->setName(name);
  return grid;
}

}  // namespace wobblebench::phantoms
