// Reading OpenVDB files. Heavy: include it from .cpp files only.
#pragma once

#include <openvdb/Grid.h>
#include <openvdb/MetaMap.h>

#include <filesystem>
#include <string>

#include "phantoms/float_grid_fwd.h"

namespace wobblebench::phantoms {

struct VdbFile {
  openvdb::GridPtrVec grids;
  openvdb::MetaMap metadata;
};

/// Reads a whole file, without delayed loading. Throws std::invalid_argument with one line that
/// says what is wrong, also for a truncated file.
[[nodiscard]] VdbFile read_vdb(const std::filesystem::path& path);

/// Bytes in memory of all grids, as the file's metadata states them, without reading the grids; 0
/// where it states none. Throws as read_vdb() does.
[[nodiscard]] double stated_bytes(const std::filesystem::path& path);

/// Throws std::invalid_argument unless the grid is of the class level set, has cubic voxels and a
/// positive background, and all its values are finite.
void check_level_set(const std::string& name, const FloatGrid& grid);

}  // namespace wobblebench::phantoms
