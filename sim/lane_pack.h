// Moves the lanes of a wide loop that are wanted to the front. That is one instruction of AVX-512
// and no loop of C++ becomes it, so that it is here by hand, beside the same in plain C++ for all
// other machines. Values are moved, none is computed.
#pragma once

#include <cstdint>

#include "sim/scatterer_cells.h"

namespace wobblebench::sim {

/// Scatterers within the beam's reach, one array for each property: apparent range, place in the
/// beam's sections, and amplitude.
struct SeenScatterers {
  float* path_m;
  std::int32_t* entry;
  float* amplitude;

  SeenScatterers from(std::size_t first) const {
    return {path_m + first, entry + first, amplitude + first};
  }
};

/// Hash cells whose scatterers are looked at together: their lanes stay in the first-level cache.
inline constexpr int kLaneCells = 32;

/// The scatterers of some hash cells, seen or not, cell after cell.
struct CellLanes {
  static constexpr int kCount = kLaneCells * kScatterersInCell;
  float path_m[kCount];
  std::int32_t entry[kCount];
  float amplitude[kCount];
  std::int32_t within[kCount];  ///< 1: seen
};

/// Writes the lanes of the first `cells` cells that are within to `to`, in order, and anything
/// behind them, as far as a cell more has room. Returns how many; `which` gets one bit for each lane
/// of each cell.
int pack_lanes(const CellLanes& lanes, int cells, const SeenScatterers& to, std::uint8_t* which);

/// Flags are looked at this many at a time: so many behind the last must be there, and be 0.
inline constexpr int kFlagsTogether = 16;

/// Writes which of the first `count` flags are 1 to `list`, in order, which has room for
/// kFlagsTogether more. Returns how many.
int list_flags(const std::uint8_t* flags, int count, std::int32_t* list);

}  // namespace wobblebench::sim
