// A file of another program: its voxels, and what it and a geometry file say of the scan.
#pragma once

#include <filesystem>
#include <string>

#include "base/user_error.h"
#include "bench/exchange/files/voxel_file.h"
#include "bench/exchange/input/coordinates.h"
#include "bench/exchange/input/geometry.h"

namespace wobblebench::bench {

/// A file, and what it and the geometry file say of it.
struct Described {
  VoxelFile file;
  Geometry geometry;
  std::string geometry_source;  ///< for refusals
  Coordinates coordinates_m;    ///< of a volume's voxels; empty: the file gives none

  [[noreturn]] void refuse(const std::string& why) const {
    throw UserError(geometry_source + ": " + why);
  }
  void need(const std::string& key, const std::string& what) const {
    if (geometry.has(key)) return;
    refuse("geometry." + key + ": is missing; must say " + what);
  }
};

/// Reads headers, no voxels. `geometry`: a file in TOML; empty: none. Throws UserError "PATH: …"
/// for a file that is damaged, or says other things than the geometry file.
Described describe_file(const std::filesystem::path& path, const std::filesystem::path& geometry);

/// The same of voxels that are described already, raw or with fields of `export`.
Described describe_voxels(VoxelFile file, const std::filesystem::path& geometry);

/// Whether `export` wrote it: its fields then tell the geometry.
bool is_of_export(const VoxelFile& file);

}  // namespace wobblebench::bench
