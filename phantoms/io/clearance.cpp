#include "phantoms/io/clearance.h"

#include <algorithm>
#include <limits>

#include "phantoms/float_grid.h"

namespace wobblebench::phantoms {
namespace {

constexpr int kMostBlocks = 128;
constexpr std::uint8_t kFar = std::numeric_limits<std::uint8_t>::max();

int floor_divided(int a, int b) {
  return a >= 0 ? a / b : -((-a + b - 1) / b);
}

}  // namespace

Clearance::Clearance(const FloatGrid& grid) {
  const openvdb::CoordBBox band = grid.evalActiveVoxelBoundingBox();
  if (band.empty()) return;
  // A block is a whole number of leaves across, so that each leaf lies in one block.
  const int leaves = band.dim()[band.maxExtent()] / 8 + 2;
  block_voxels_ = 8 * ((leaves + kMostBlocks - 1) / kMostBlocks);
  blocks_ = {block_of(band.min()), block_of(band.max())};
  steps_.assign(blocks_.volume(), kFar);
  std::vector<openvdb::Coord> occupied;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    if (leaf->isEmpty()) continue;
    const openvdb::Coord block = block_of(leaf->origin());
    if (steps_[index_of(block)] == 0) continue;
    steps_[index_of(block)] = 0;
    occupied.push_back(block);
  }
  propagate(std::move(occupied));
}

openvdb::Coord Clearance::block_of(const openvdb::Coord& voxel) const {
  return {floor_divided(voxel.x(), block_voxels_),
          floor_divided(voxel.y(), block_voxels_),
          floor_divided(voxel.z(), block_voxels_)};
}

std::size_t Clearance::index_of(const openvdb::Coord& block) const {
  const openvdb::Coord at = block - blocks_.min(), size = blocks_.dim();
  return (static_cast<std::size_t>(at.x()) * static_cast<std::size_t>(size.y()) +
          static_cast<std::size_t>(at.y())) *
             static_cast<std::size_t>(size.z()) +
         static_cast<std::size_t>(at.z());
}

// Breadth first, one shell of blocks at a time, over faces, edges and corners.
void Clearance::propagate(std::vector<openvdb::Coord> shell) {
  for (std::uint8_t step = 1; !shell.empty() && step < kFar; ++step) {
    std::vector<openvdb::Coord> next;
    for (const openvdb::Coord& block : shell) {
      openvdb::CoordBBox around(block.offsetBy(-1), block.offsetBy(1));
      around.intersect(blocks_);
      for (const openvdb::Coord& neighbour : around) {
        std::uint8_t& known = steps_[index_of(neighbour)];
        if (known <= step) continue;
        known = step;
        next.push_back(neighbour);
      }
    }
    shell = std::move(next);
  }
}

double Clearance::voxels(const openvdb::Coord& voxel) const {
  if (steps_.empty()) return std::numeric_limits<double>::infinity();
  const openvdb::Coord block = block_of(voxel);
  if (blocks_.isInside(block)) {
    return block_voxels_ * std::max(0.0, steps_[index_of(block)] - 1.0);
  }
  int beyond = 0;
  for (int axis = 0; axis < 3; ++axis) {
    beyond = std::max(
        {beyond, blocks_.min()[axis] - block[axis] - 1, block[axis] - blocks_.max()[axis] - 1});
  }
  return 1.0 * block_voxels_ * beyond;
}

}  // namespace wobblebench::phantoms
