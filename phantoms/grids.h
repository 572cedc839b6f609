// The grids of a phantom, as OpenVDB level sets, and their size in memory. Light: what reads their
// voxels includes phantoms/float_grid.h too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "phantoms/float_grid_fwd.h"
#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

/// Signed distances in metres (negative inside), world space = phantom frame in metres, in the
/// order of Phantom::surfaces(); narrow band, outside it signed background and flooded tiles.
struct Grids {
  std::vector<std::shared_ptr<const FloatGrid>> signed_distance;
};

struct GridMemory {
  double voxel_m = 0;
  std::uint64_t voxels = 0;  ///< active: within the narrow band
  std::uint64_t bytes = 0;   ///< in memory
};

/// Size of the grid of Phantom::surfaces()[surface].
GridMemory grid_memory(const Phantom& phantom, std::size_t surface);

}  // namespace wobblebench::phantoms
