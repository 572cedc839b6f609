// The scatterers of hash cells as a stick sees them, in loops that compilers make wide: one
// scatterer of many cells at a time, so that those that their octave has silenced cost nothing.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/beam/beam_vector.h"
#include "sim/math/stream_compaction.h"
#include "sim/tissue/tissue_parcels.h"

namespace wobblebench::sim {

/// The beam for hash cells whose middle lies nearest to one row of its table. A path is
/// late + stretch * axial, a bend bend + slope * axial; columns are those of the table.
struct alignas(32) BeamAtRow {
  float lateral_columns_per_m = 0;
  float elevation_columns_per_m = 0;
  float late_m = 0;
  float stretch = 1;
  float lateral_bend_per_m = 0;
  float lateral_slope_per_m2 = 0;
  float elevation_bend_per_m = 0;
  float elevation_slope_per_m2 = 0;
};

/// The same for how an octave's cells are heard there: the first of their scatterers in full, then
/// one that may be fainter, and no others. Amplitudes are those of an echo from the axis in tissue
/// of echo power 1.
struct alignas(16) OctaveAtRow {
  float full = 0;
  float faint = 0;
  std::int32_t in_full = 0;
  std::int32_t heard = 0;

  float amplitude(int scatterer) const {
    return scatterer < in_full ? full : (scatterer < heard ? faint : 0.0f);
  }
};

/// Where a hash cell begins (kHashOrigin of sim/scatterers/scatterer_cells.h): axial, lateral,
/// elevation and nothing, which move and add up as one.
struct CellOrigin {
  float __attribute__((vector_size(16))) at = {0, 0, 0, 0};

  CellOrigin() = default;
  explicit CellOrigin(const BeamVector& v) : at{v.axial, v.lateral, v.elevation, 0} {}
};
inline CellOrigin operator+(CellOrigin a, const CellOrigin& b) {
  a.at += b.at;
  return a;
}

/// Hash cells that the beam touches, one array for each property.
struct TouchedHashCells {
  CellOrigin* origin;
  std::uint32_t* seed;
  float* amplitude;  ///< of its tissue

  TouchedHashCells from(std::size_t first) const {
    return {origin + first, seed + first, amplitude + first};
  }
};

/// What one hash unit along each of the tissue's axes is in beam coordinates.
struct HashAxes {
  BeamVector x;
  BeamVector y;
  BeamVector z;
  float to_middle;  ///< of a cell from its hash origin, along the beam
};

/// What all scatterers of a stick and an octave share.
struct Sight {
  const BeamAtRow* rows;
  const OctaveAtRow* octave;  ///< by row; not looked at for given places
  std::int32_t columns;       ///< of the beam's table
  std::int32_t last_row;
  float rows_per_m;
  BeamRim rim;
};

/// A scatterer whose amplitude depends on the direction of the sound.
struct SheetHit {
  std::int32_t seen;       ///< its place in what is seen
  std::int32_t cell;       ///< of those given
  std::int32_t scatterer;  ///< in its cell
};

/// For mixed cells: what each holds, and where those scatterers go that lie in sheets (room for
/// all). Silent ones are left out.
struct MixedSight {
  const MixedCell* const* cells;
  SheetHit* hits;
  int hit_count = 0;
};

/// Writes the cells' scatterers within reach to `seen`, which has room for all of them and
/// kFlagsTogether more; so have the arrays of `cells`. `mixed`: null for cells of one material.
/// Returns how many.
int see_scatterers(const TouchedHashCells& cells,
                   int count,
                   const HashAxes& axes,
                   const Sight& sight,
                   const SeenScatterers& seen,
                   MixedSight* mixed = nullptr);

/// A scatterer at a given place, with the nearest row of the beam's table.
struct BeamPlace {
  BeamVector at;
  float amplitude = 0;
  std::int32_t row = 0;
};
/// Writes it to `seen` if it is within reach. Returns how many that are.
int see_place(const BeamPlace& place, const Sight& sight, const SeenScatterers& seen);

}  // namespace wobblebench::sim
