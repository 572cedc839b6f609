// A level set as bytes, for the cache and for the process that reads files of others.
#pragma once

#include <memory>

#include "base/byte_stream.h"
#include "phantoms/grids.h"

namespace wobblebench::phantoms {

/// Writes a level set whose inactive values are all plus or minus the background, whose voxels are
/// scaled alike along all axes and moved at most, and that has no metadata but its name: such as
/// this program's shapes. Returns whether it is one; if not, what was written is of no use.
bool write_level_set(const FloatGrid& grid, ByteWriter& to);

/// The same grid: every value, voxel and tile, and its size in memory. Throws DamagedBytes.
std::shared_ptr<FloatGrid> read_level_set(ByteReader& from);

}  // namespace wobblebench::phantoms
