#include "render/leaping/macrocells.h"

#include <algorithm>
#include <bit>

namespace wobblebench::render {
namespace {

constexpr int kMostColumns = 64;  ///< a row of cells is one word of bits
constexpr int kSmallestCellPixels = 4;

/// Every word joined with its neighbours in its group of `count` words, `stride` apart.
void widen(CellBits& words, std::size_t count, std::size_t stride) {
  const CellBits before = words;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::size_t place = i / stride % count;
    if (place > 0) words[i] |= before[i - stride];
    if (place + 1 < count) words[i] |= before[i + stride];
  }
}

/// The set and all cells next to it.
CellBits widened(CellBits set, const MacrocellGrid& lattice) {
  for (std::uint64_t& word : set) word = carried(word, 1, 1) & all_columns(lattice);
  const auto rows = static_cast<std::size_t>(lattice.rows);
  widen(set, rows, 1);
  widen(set, static_cast<std::size_t>(lattice.intervals), rows);
  return set;
}

}  // namespace

MacrocellGrid make_macrocell_grid(const SliceGeometry& geometry, const Region& pixels) {
  const auto cells = [](int count, int side) { return (count + side - 1) / side; };
  MacrocellGrid l;
  l.pixels = pixels;
  l.cell_pixels = std::max(kSmallestCellPixels, cells(pixels.columns, kMostColumns));
  l.columns = cells(pixels.columns, l.cell_pixels);
  l.rows = cells(pixels.rows, l.cell_pixels);
  l.intervals = std::max(geometry.frames() - 1, 1);
  return l;
}

std::uint64_t all_columns(const MacrocellGrid& lattice) {
  return ~std::uint64_t{0} >> (kMostColumns - lattice.columns);
}

std::uint64_t carried(std::uint64_t bits, int down, int up) {
  std::uint64_t all = bits;
  for (int i = 1; i <= std::min(down, kMostColumns - 1); ++i) all |= bits >> i;
  for (int i = 1; i <= std::min(up, kMostColumns - 1); ++i) all |= bits << i;
  return all;
}

std::vector<std::uint8_t> cell_distances(const CellBits& set, const MacrocellGrid& lattice) {
  const auto columns = static_cast<std::size_t>(lattice.columns);
  std::vector<std::uint8_t> distances(columns * set.size(), kFarthestCell);
  const auto mark = [&](std::size_t word, std::uint64_t bits, int distance) {
    for (; bits != 0; bits &= bits - 1) {
      distances[word * columns + static_cast<std::size_t>(std::countr_zero(bits))] =
          static_cast<std::uint8_t>(distance);
    }
  };
  CellBits reached = set;
  for (std::size_t word = 0; word < reached.size(); ++word) mark(word, reached[word], 0);
  for (int distance = 1; distance < kFarthestCell; ++distance) {
    CellBits next = widened(reached, lattice);
    if (next == reached) break;
    for (std::size_t word = 0; word < next.size(); ++word) {
      mark(word, next[word] & ~reached[word], distance);
    }
    reached = std::move(next);
  }
  return distances;
}

}  // namespace wobblebench::render
