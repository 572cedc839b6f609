// OpenVDB files as they come from disk. Heavy: include it from .cpp files only.
#pragma once

#include <openvdb/openvdb.h>

#include <filesystem>
#include <string>

namespace wobblebench::phantoms {

struct VdbFile {
  openvdb::GridPtrVec grids;
  openvdb::MetaMap metadata;
};

/// Reads a file whole, nothing left to be loaded later. Throws std::invalid_argument with one line
/// that says what is wrong, also for a file that is cut short.
VdbFile read_vdb(const std::filesystem::path& path);

/// Bytes in memory of all grids, as the file states them, read ahead of the grids; 0 where it does
/// not say. Throws as read_vdb() does.
double stated_bytes(const std::filesystem::path& path);

/// Throws std::invalid_argument unless the grid is of the class level set, has cubic voxels and a
/// positive background, and all its values are finite.
void check_level_set(const std::string& name, const openvdb::FloatGrid& grid);

}  // namespace wobblebench::phantoms
