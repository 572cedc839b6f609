#include "phantoms/grid_memory.h"

#include "phantoms/grids.h"

namespace wobblebench::phantoms {

GridMemory grid_memory(const Phantom& phantom, std::size_t surface) {
  const openvdb::FloatGrid& grid = *phantom.grids().signed_distance.at(surface);
  return {grid.voxelSize()[0], grid.activeVoxelCount(), grid.memUsage()};
}

}  // namespace wobblebench::phantoms
