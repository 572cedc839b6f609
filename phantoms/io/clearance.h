// How much room there is around the narrow band of a level set. Heavy: include it from .cpp files
// only.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <vector>

namespace wobblebench::phantoms {

/// Blocks of voxels, each with the number of blocks to the nearest that holds a part of the band.
/// At most 128 blocks a side, however large the grid.
class Clearance {
 public:
  explicit Clearance(const openvdb::FloatGrid& grid);

  /// A distance, in voxels, within which no voxel of the band lies; 0 near it.
  double voxels(const openvdb::Coord& at) const;

 private:
  openvdb::Coord block_of(const openvdb::Coord& voxel) const;
  std::size_t slot(const openvdb::Coord& block) const;
  void count_from(std::vector<openvdb::Coord> occupied);

  int block_voxels_ = 8;
  openvdb::CoordBBox blocks_;
  std::vector<std::uint8_t> steps_;  ///< [slot of the block]
};

}  // namespace wobblebench::phantoms
