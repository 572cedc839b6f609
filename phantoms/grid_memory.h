// What a phantom's grids take.
#pragma once

#include <cstddef>
#include <cstdint>

#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

struct GridMemory {
  double voxel_m = 0;
  std::uint64_t voxels = 0;  ///< active: within the narrow band
  std::uint64_t bytes = 0;   ///< in memory
};

/// Of the grid of Phantom::surfaces()[surface].
GridMemory grid_memory(const Phantom& phantom, std::size_t surface);

}  // namespace wobblebench::phantoms
