// Scatterers within the beam of one stick, and stream compaction: moving the selected elements of
// an array to its front. AVX-512 has an instruction for it that compilers do not generate from a
// C++ loop, so this has a version with intrinsics and a portable one. Values are moved, none is
// computed.
#pragma once

#include <cstddef>
#include <cstdint>

namespace wobblebench::sim {

/// Scatterers within the beam of one stick, one array per property.
struct ProjectedScatterers {
  float* range_m;              ///< apparent range of the echo
  std::uint32_t* table_index;  ///< entries of the BeamTable: lateral in the low 16 bits, elevation
                               ///< in the high 16 bits
  float* amplitude;

  ProjectedScatterers from(std::size_t first) const {
    return {range_m + first, table_index + first, amplitude + first};
  }
};

/// Elements compacted at a time: counts are multiples of it, and outputs need room for this many
/// more elements than are selected.
inline constexpr int kCompactionWidth = 16;

/// Hash cells projected at a time: their intermediate arrays fit the first-level cache.
inline constexpr int kCellsPerBatch = 64;

/// One scatterer of each hash cell of a batch, before selection.
struct ScattererLanes {
  float range_m[kCellsPerBatch];
  std::uint32_t table_index[kCellsPerBatch];
  float amplitude[kCellsPerBatch];
  std::int32_t selected[kCellsPerBatch];  ///< 1 or 0
};

/// Writes those of the first `count` lanes that are selected to `to`, in order; up to
/// kCompactionWidth elements behind them are overwritten. `count` is a multiple of
/// kCompactionWidth. `mask` receives one bit a lane, 8 to a byte. Returns how many were selected.
int compact_scatterers(const ScattererLanes& lanes,
                       int count,
                       const ProjectedScatterers& to,
                       std::uint8_t* mask);

/// Writes the indices of those of the first `count` flags that are 1 to `list`, in order. Counts
/// and room as for compact_scatterers(). Returns how many.
int list_set_flags(const std::uint8_t* flags, int count, std::int32_t* list);

}  // namespace wobblebench::sim
