// Where a header of NRRD or MetaImage says that its voxels are, and how they are stored.
#pragma once

#include "bench/exchange/files/voxel_file.h"

namespace wobblebench::bench {

struct StoredVoxels {
  enum class As { raw, deflated, text };
  As as = As::raw;
  std::string field;  ///< that names their file, for refusals
  std::string file;   ///< beside the header; empty: they follow it
  std::int64_t skipped_lines = 0;
  std::int64_t skipped_bytes = 0;          ///< of raw voxels; -1: all but the file's last bytes
  std::optional<std::int64_t> bytes = {};  ///< that deflated ones take
};

/// Sets where the voxels are; those that are no raw ones are read into a file in memory. Throws
/// UserError "PATH: …" where they are not all there, or bytes are left over, before memory is taken
/// for what a header claims.
void take_voxels(const StoredVoxels& stored, VoxelFile& file);

/// Throws UserError where voxels or samples would take more than half of the memory.
void check_half_of_memory(const std::filesystem::path& path, double bytes);

/// The voxels as a file in memory, which `data_path` then names.
void keep_in_memory(VoxelFile& file, std::span<const std::byte> bytes);

}  // namespace wobblebench::bench
