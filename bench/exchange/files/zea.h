// Pictures in HDF5 files of zea (github.com/tue-bmd/zea, zea/data/spec.py), read in a process of
// their own.
#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <vector>

#include "bench/exchange/files/voxel_file.h"

namespace wobblebench::bench {

/// -infinity dB is the least number of a float.
struct ZeaPicture {
  VoxelFile file;            ///< y, x, z, volumes, or x, z, frames, fastest first
  bool is_envelope = false;  ///< linear values; else dB, 0 the brightest, or grey values of 8 bits
  std::vector<glm::dvec3> coordinates_m;  ///< of the first volume's voxels; empty: not given
};

/// Fields of the file are those of its description that `export` wrote. Throws UserError "PATH: …".
ZeaPicture read_zea(const std::filesystem::path& path);

}  // namespace wobblebench::bench
