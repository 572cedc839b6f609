// OpenVDB files, read by wobblebench-import. Heavy: include it from .cpp files only.
#pragma once

#include <openvdb/Grid.h>
#include <openvdb/MetaMap.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "phantoms/grids.h"

namespace wobblebench::phantoms {

/// Metadata entry of the files that write_phantom() wrote: the version of their format.
inline constexpr const char* kVersionKey = "wobblebench_phantom_version";

struct VdbGrid {
  std::string name;
  std::string value_type;    ///< "float", "int32", …
  std::string grid_class;    ///< "level set", "fog volume", …
  FloatGrid::Ptr distances;  ///< grid of floats or doubles on a lattice; null for others
};

struct VdbFile {
  std::vector<VdbGrid> grids;
  openvdb::MetaMap metadata;  ///< text, doubles, integers, flags and vectors; others are left out
};

/// Reads a whole file. Throws std::invalid_argument with one line that says what is wrong, also for
/// a truncated file and for one that ends its reader; ImportUnavailable where there is no reader.
[[nodiscard]] VdbFile read_vdb(const std::filesystem::path& path);

/// The file of a message, of which nothing is trusted. Throws std::invalid_argument.
[[nodiscard]] VdbFile vdb_from_message(std::string_view message);

/// Throws std::invalid_argument unless the grid is of the class level set, has cubic voxels and a
/// positive background, and all its values are finite.
void check_level_set(const std::string& name, const FloatGrid& grid);

}  // namespace wobblebench::phantoms
