// A level set as bytes, for a cache.
#pragma once

#include <memory>

#include "base/byte_stream.h"
#include "phantoms/float_grid_fwd.h"

namespace wobblebench::phantoms {

/// Writes a level set whose inactive values are all plus or minus the background, whose voxels are
/// scaled alike along all axes and moved at most, and that has no metadata but its name: such as
/// this program's shapes. Returns whether it is one; if not, what was written is of no use.
[[nodiscard]] bool write_grid(const FloatGrid& grid, ByteWriter& to);

/// The same grid: every value, voxel and tile, and its size in memory. Throws DamagedBytes.
[[nodiscard]] std::shared_ptr<FloatGrid> read_grid(ByteReader& from);

}  // namespace wobblebench::phantoms
