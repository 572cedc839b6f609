// The cells that empty space is told in, sets of them as bits, and distances between them.
#pragma once

#include <cstdint>
#include <vector>

#include "render/passes/region.h"
#include "render/passes/slice_geometry.h"

namespace wobblebench::render {

/// The pixels of slices that rays reach, cut into square cells, by the intervals between frames.
/// The last column and row of cells may reach beyond the pixels.
struct MacrocellGrid {
  Region pixels;
  int cell_pixels = 1;  ///< a side
  int columns = 0, rows = 0, intervals = 0;
};
MacrocellGrid make_macrocell_grid(const SliceGeometry& geometry, const Region& pixels);

/// A set of cells: a word for each [interval][row], a bit for each column.
using CellBits = std::vector<std::uint64_t>;

/// A word with a bit for each column of the lattice.
std::uint64_t all_columns(const MacrocellGrid& lattice);

/// A row of bits, each carried on by up to so many columns.
std::uint64_t carried(std::uint64_t bits, int down, int up);

inline constexpr int kFarthestCell = 255;

/// For each cell ([interval][row][column]), how many cells away the nearest of the set is, along
/// the farthest axis, at most kFarthestCell.
std::vector<std::uint8_t> cell_distances(const CellBits& set, const MacrocellGrid& lattice);

}  // namespace wobblebench::render
