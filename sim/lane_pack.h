// Moves the lanes of a wide loop that are wanted to the front. That is one instruction of AVX-512
// and no loop of C++ becomes it, so that it is here by hand, beside the same in plain C++ for all
// other machines. Values are moved, none is computed.
#pragma once

#include <cstddef>
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

/// Hash cells that the beam touches, one array for each property.
struct TouchedHashCells {
  float* axial;  ///< low corner, in beam coordinates (m)
  float* lateral;
  float* elevation;
  float* amplitude;  ///< of its tissue
  std::uint32_t* key;
  std::int32_t* row;  ///< of the beam's table

  TouchedHashCells from(std::size_t first) const {
    return {axial + first,
            lateral + first,
            elevation + first,
            amplitude + first,
            key + first,
            row + first};
  }
};

/// Flags are looked at this many at a time: their number is a multiple of it, and what is moved by
/// them needs so much more room.
inline constexpr int kFlagsTogether = 16;

/// Hash cells of a parcel, whether the beam touches them or not.
struct TestedCells {
  static constexpr int kCount = kMostCells + kFlagsTogether;
  float axial[kCount];
  float lateral[kCount];
  float elevation[kCount];
  std::uint32_t key[kCount];
  std::int32_t row[kCount];
  std::uint8_t near[kCount];  ///< 1: touched
};

/// Writes those of the first `count` cells whose flag is 1 to `to`, in order, but for their
/// amplitudes. Returns how many.
int pack_cells(const TestedCells& cells,
               const std::uint8_t* flags,
               int count,
               const TouchedHashCells& to);

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
/// behind them, as far as a cell more has room. Returns how many; `which` gets one bit for each
/// lane of each cell.
int pack_lanes(const CellLanes& lanes, int cells, const SeenScatterers& to, std::uint8_t* which);

/// Writes which of the first `count` flags are 1 to `list`, in order. Returns how many.
int list_flags(const std::uint8_t* flags, int count, std::int32_t* list);

}  // namespace wobblebench::sim
