#include "phantoms/float_grid.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/FastSweeping.h>

#include "phantoms/grids.h"
#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

void initialize_openvdb() {
  openvdb::initialize();
}

FloatGrid::Ptr create_level_set(double voxel_m, double background_m) {
  auto grid = FloatGrid::create(static_cast<float>(background_m));
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel_m));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

FloatGrid::Ptr deep_copy(const FloatGrid& grid) {
  return grid.deepCopy();
}

bool has_both_sides(const FloatGrid& grid) {
  bool inside = false, outside = false;
  for (auto value = grid.cbeginValueOn(); value && !(inside && outside); ++value) {
    inside |= *value < 0;
    outside |= *value > 0;
  }
  return inside && outside;
}

FloatGrid::Ptr widen_band(const FloatGrid& grid, int layers, Neighbours neighbours) {
  if (!has_both_sides(grid)) return deep_copy(grid);
  return openvdb::tools::dilateSdf(
      grid,
      layers,
      neighbours == Neighbours::faces ? openvdb::tools::NN_FACE : openvdb::tools::NN_FACE_EDGE);
}

GridMemory grid_memory(const Phantom& phantom, std::size_t surface) {
  const FloatGrid& grid = *phantom.grids().signed_distance.at(surface);
  return {grid.voxelSize()[0], grid.activeVoxelCount(), grid.memUsage()};
}

}  // namespace wobblebench::phantoms
