// Parts of the message of a .vdb: what wobblebench-import writes and vdb_file.cpp reads.
//
// Metadata entries until VdbMetadata::end, each a type, a key and a value; then grids until
// VdbContents::end, each with name, value type and class, and for a grid of floats on a lattice its
// matrix (16 doubles, row by row), background, tiles until kNoMoreTiles, and leaves.
#pragma once

#include <array>
#include <cstdint>

namespace wobblebench::phantoms {

enum class VdbMetadata : std::uint32_t { end, text, number, integer, flag, vector };
enum class VdbContents : std::uint32_t { end, name_alone, distances };

/// One value for a cube of voxels: a tile of OpenVDB's tree.
struct VdbTile {
  std::array<std::int32_t, 3> low;  ///< least index of its voxels
  std::int32_t level;               ///< 1: 8 voxels a side, 2: 128, 3: 4096
  std::int32_t active;
  float value;
};
inline constexpr std::int32_t kNoMoreTiles = -1;

struct VdbLeaf {
  static constexpr std::uint32_t kVoxels = 512;
  std::array<std::int32_t, 3> low;
  std::array<float, kVoxels> values;
  std::array<std::uint64_t, kVoxels / 64> active;
};

}  // namespace wobblebench::phantoms
