// Macrocells of the slices for empty-space leaping, sets of them as bits, and distances between
// them.
#pragma once

#include <cstdint>
#include <vector>

#include "render/geometry/slice_geometry.h"
#include "render/gl/region.h"

namespace wobblebench::render {

/// Grid of macrocells: square cells of the pixels that rays reach, times the intervals between
/// frames. The last column and row of cells may extend beyond the pixels.
struct MacrocellGrid {
  Region pixels;
  int cell_pixels = 1;  ///< per side
  int columns = 0, rows = 0, intervals = 0;
};
MacrocellGrid make_macrocell_grid(const SliceGeometry& geometry, const Region& pixels);

/// A set of cells: a word for each [interval][row], a bit for each column.
using CellBits = std::vector<std::uint64_t>;

/// A word with a bit for each column of the grid.
std::uint64_t column_mask(const MacrocellGrid& grid);

/// A row dilated by `down` columns towards column 0 and `up` columns away from it.
std::uint64_t dilated_columns(std::uint64_t bits, int down, int up);

inline constexpr int kMaxCellDistance = 255;

/// For each cell ([interval][row][column]), the Chebyshev distance in cells to the nearest one of
/// the set, at most kMaxCellDistance.
std::vector<std::uint8_t> cell_distances(const CellBits& set, const MacrocellGrid& grid);

}  // namespace wobblebench::render
