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

/// An empty file in memory, which `data_path` then names; and bytes at its end.
void open_memory(VoxelFile& file);
void keep_in_memory(const VoxelFile& file, std::string_view bytes);

}  // namespace wobblebench::bench
