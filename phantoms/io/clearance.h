// Distance from a voxel to the narrow band of a level set, as a lower bound. Heavy: include it from
// .cpp files only.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <vector>

#include "phantoms/float_grid_fwd.h"

namespace wobblebench::phantoms {

/// Chebyshev distance transform over blocks of voxels: for each block, the number of blocks to the
/// nearest one that holds a voxel of the band. At most 128 blocks a side, however large the grid.
class Clearance {
 public:
  explicit Clearance(const FloatGrid& grid);

  /// A distance, in voxels, within which no voxel of the band lies; 0 near the band.
  double voxels(const openvdb::Coord& voxel) const;

 private:
  openvdb::Coord block_of(const openvdb::Coord& voxel) const;
  std::size_t index_of(const openvdb::Coord& block) const;
  void propagate(std::vector<openvdb::Coord> occupied);

  int block_voxels_ = 8;
  openvdb::CoordBBox blocks_;
  std::vector<std::uint8_t> steps_;  ///< [index of the block]
};

}  // namespace wobblebench::phantoms
