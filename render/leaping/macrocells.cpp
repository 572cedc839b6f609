#include "render/leaping/macrocells.h"

#include <algorithm>
#include <bit>

namespace wobblebench::render {
namespace {

constexpr int kMaxColumns = 64;  ///< a row of cells is one word of bits
constexpr int kMinCellPixels = 4;

/// Dilates by one cell along an axis of `count` words that are `stride` apart.
void dilate_along(CellBits& words, std::size_t count, std::size_t stride) {
  const CellBits before = words;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::size_t index = i / stride % count;
    if (index > 0) words[i] |= before[i - stride];
    if (index + 1 < count) words[i] |= before[i + stride];
  }
}

/// The set and all cells adjacent to it.
CellBits dilated_by_one(CellBits set, const MacrocellGrid& grid) {
  for (std::uint64_t& word : set) word = dilated_columns(word, 1, 1) & column_mask(grid);
  const auto rows = static_cast<std::size_t>(grid.rows);
  dilate_along(set, rows, 1);
  dilate_along(set, static_cast<std::size_t>(grid.intervals), rows);
  return set;
}

}  // namespace

MacrocellGrid make_macrocell_grid(const SliceGeometry& geometry, const Region& pixels) {
  const auto cells = [](int count, int side) { return (count + side - 1) / side; };
  MacrocellGrid grid;
  grid.pixels = pixels;
  grid.cell_pixels = std::max(kMinCellPixels, cells(pixels.columns, kMaxColumns));
  grid.columns = cells(pixels.columns, grid.cell_pixels);
  grid.rows = cells(pixels.rows, grid.cell_pixels);
  grid.intervals = std::max(geometry.frames() - 1, 1);
  return grid;
}

std::uint64_t column_mask(const MacrocellGrid& grid) {
  return ~std::uint64_t{0} >> (kMaxColumns - grid.columns);
}

std::uint64_t dilated_columns(std::uint64_t bits, int down, int up) {
  std::uint64_t all = bits;
  for (int i = 1; i <= std::min(down, kMaxColumns - 1); ++i) all |= bits >> i;
  for (int i = 1; i <= std::min(up, kMaxColumns - 1); ++i) all |= bits << i;
  return all;
}

std::vector<std::uint8_t> cell_distances(const CellBits& set, const MacrocellGrid& grid) {
  const auto columns = static_cast<std::size_t>(grid.columns);
  std::vector<std::uint8_t> distances(columns * set.size(), kMaxCellDistance);
  const auto mark = [&](std::size_t word, std::uint64_t bits, int distance) {
    for (; bits != 0; bits &= bits - 1) {
      distances[word * columns + static_cast<std::size_t>(std::countr_zero(bits))] =
          static_cast<std::uint8_t>(distance);
    }
  };
  CellBits reached = set;
  for (std::size_t word = 0; word < reached.size(); ++word) mark(word, reached[word], 0);
  for (int distance = 1; distance < kMaxCellDistance; ++distance) {
    CellBits next = dilated_by_one(reached, grid);
    if (next == reached) break;
    for (std::size_t word = 0; word < next.size(); ++word) {
      mark(word, next[word] & ~reached[word], distance);
    }
    reached = std::move(next);
  }
  return distances;
}

}  // namespace wobblebench::render
