// Moves the lanes of a wide loop that are wanted to the front. That is one instruction of AVX-512
// and no loop of C++ becomes it, so that it is here by hand, beside the same in plain C++ for all
// other machines. Values are moved, none is computed.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/scatterers/scatterer_cells.h"

namespace wobblebench::sim {

/// Scatterers within the beam's reach, one array for each property: apparent range, places in the
/// beam's table (lateral in the low, elevation in the high 16 bits), and amplitude.
struct SeenScatterers {
  float* path_m;
  std::uint32_t* places;
  float* amplitude;

  SeenScatterers from(std::size_t first) const {
    return {path_m + first, places + first, amplitude + first};
  }
};

/// Flags are looked at this many at a time: their number is a multiple of it, and what is moved by
/// them needs so much more room.
inline constexpr int kFlagsTogether = 16;

/// Hash cells that are looked at together: their lanes stay in the first-level cache.
inline constexpr int kLaneCells = 64;

/// A scatterer of each of some hash cells, seen or not.
struct ScattererLanes {
  float path_m[kLaneCells];
  std::uint32_t places[kLaneCells];
  float amplitude[kLaneCells];
  std::int32_t within[kLaneCells];  ///< 1: seen
};

/// Writes the first `count` lanes that are within to `to`, in order, and anything behind them, as
/// far as kFlagsTogether more have room. `count` is a multiple of that. Returns how many; `which`
/// gets a bit for each lane, 8 to a byte.
int pack_lanes(const ScattererLanes& lanes,
               int count,
               const SeenScatterers& to,
               std::uint8_t* which);

/// Writes which of the first `count` flags are 1 to `list`, in order. Returns how many.
int list_flags(const std::uint8_t* flags, int count, std::int32_t* list);

}  // namespace wobblebench::sim
