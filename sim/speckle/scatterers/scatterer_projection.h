// Projects the scatterers of hash cells into the beam of one stick. The vectorised loops run over
// cells, one scatterer of each at a time, so that scatterers that do not contribute in their octave
// are not computed.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/math/fast_math.h"
#include "sim/optics/beam_table.h"
#include "sim/speckle/scatterers/stream_compaction.h"

namespace wobblebench::sim {

/// Beam coordinates in single precision, for vectorised loops: metres along the stick, across it in
/// the image plane, and across the image plane. The resolution of a float is 1e-8 m there, 1e-4 of
/// a cycle.
struct BeamVector {
  float axial = 0;
  float lateral = 0;
  float elevation = 0;
};

/// Shape of the beam's edge across the axis: an ellipse whose half axes are the reach in both
/// directions, or, for side lobes, a diamond, on which the two offsets relative to their reach add
/// up to 1.
enum class BeamRim { ellipse, diamond };

/// `u` and `v`: magnitudes of the offsets in both directions, scaled to a common `reach`.
template <BeamRim rim>
WOBBLEBENCH_INLINE bool within_rim(float u, float v, float reach) {
  return rim == BeamRim::ellipse ? u * u + v * v < reach * reach : u + v < reach;
}

struct MixedCell;

/// The beam for hash cells whose centre lies in one row of its table. Apparent range: delay +
/// range_scale * axial + tilt * offset + curvature * offset^2 for both directions; the elevation
/// has no tilt. Columns are those of the table, of offsets on the positive side. Columns, tilt and
/// curvature are linear in the axial position, so that the beam is as wide as at the cell's centre.
struct alignas(32) BeamAtRow {
  float lateral_columns_per_m = 0;  ///< negative where the beam is the table's mirror image
  float lateral_columns_slope_per_m2 = 0;
  float elevation_columns_per_m = 0;
  float elevation_columns_slope_per_m2 = 0;
  float delay_m = 0;
  float range_scale = 1;
  float lateral_tilt = 0;
  float lateral_tilt_slope_per_m = 0;
  float lateral_curvature_per_m = 0;
  float lateral_curvature_slope_per_m2 = 0;
  float elevation_curvature_per_m = 0;
  float elevation_curvature_slope_per_m2 = 0;
  std::uint32_t first_index = 0;  ///< first_table_index()

  float lateral_columns_at(float axial_m) const {
    return lateral_columns_per_m + lateral_columns_slope_per_m2 * axial_m;
  }
  float elevation_columns_at(float axial_m) const {
    return elevation_columns_per_m + elevation_columns_slope_per_m2 * axial_m;
  }
};

/// Table index of the first entry of a row in each direction.
inline std::uint32_t first_table_index(int row, int columns) {
  const int elevation = row * BeamTable::kElevationParts * columns;
  return static_cast<std::uint32_t>(2 * row * columns) | static_cast<std::uint32_t>(elevation)
                                                             << 16;
}
/// An axial position clamped to its row: the first and the last row are used for all positions
/// before and behind them, where their lines could cross 0.
WOBBLEBENCH_INLINE float within_row(float axial_m, float rows_per_m, int row) {
  const float begin_m = static_cast<float>(row) / rows_per_m;
  const float end_m = static_cast<float>(row + 1) / rows_per_m;
  const float behind_begin = axial_m > begin_m ? axial_m : begin_m;
  return behind_begin < end_m ? behind_begin : end_m;
}

/// Table index of the part of a row that contains an axial position, relative to the row's first
/// part.
WOBBLEBENCH_INLINE std::uint32_t part_index(float axial_m, float rows_per_m, int row, int columns) {
  const float within = axial_m * rows_per_m - static_cast<float>(row);
  std::int32_t part = static_cast<std::int32_t>(within * BeamTable::kElevationParts);
  part = part < 0 ? 0 : part;
  part = part < BeamTable::kElevationParts ? part : BeamTable::kElevationParts - 1;
  return static_cast<std::uint32_t>(part * columns) << 16;
}

/// Amplitudes of the scatterers of an octave's cells in one row: the first `full_count` have
/// `full`, then one may have `partial`, up to `count`; the others do not contribute. They are the
/// amplitudes of echoes from the axis in tissue of echo power 1.
struct alignas(16) OctaveAtRow {
  float full = 0;
  float partial = 0;
  std::int32_t full_count = 0;
  std::int32_t count = 0;

  float amplitude(int scatterer) const {
    return scatterer < full_count ? full : (scatterer < count ? partial : 0.0f);
  }
};

/// Origin of a hash cell in beam coordinates (kHashOrigin of
/// sim/speckle/scatterers/scatterer_cells.h): axial, lateral, elevation and padding, as one SIMD
/// register.
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
struct HashCellArrays {
  CellOrigin* origin;
  std::uint32_t* seed;
  float* amplitude;  ///< of the cell's tissue

  HashCellArrays from(std::size_t first) const {
    return {origin + first, seed + first, amplitude + first};
  }
};

/// One hash unit along each of the tissue's axes, in beam coordinates.
struct HashAxes {
  BeamVector x;
  BeamVector y;
  BeamVector z;
  float to_center;  ///< axial distance of a cell's centre from its origin
};

/// The axes of some cells: one for all of them, or one for each.
struct CellAxes {
  const HashAxes* axes;
  bool each;

  CellAxes from(std::size_t first) const { return {each ? axes + first : axes, each}; }
};

/// The beam and one octave, for all scatterers of a stick.
struct BeamProjection {
  const BeamAtRow* rows;
  const OctaveAtRow* octave;  ///< by row; not used by project_point()
  std::int32_t columns;       ///< of the beam's table, on one side of the axis
  std::int32_t last_row;
  float rows_per_m;
  BeamRim rim;
};

/// A projected scatterer near a rough interface: its amplitude depends on the direction of the
/// sound.
struct InterfaceHit {
  std::int32_t projected;  ///< index among the projected scatterers
  std::int32_t cell;       ///< index among the given cells
  std::int32_t scatterer;  ///< number in its cell
};

/// Input and output for mixed cells: the tissue of each scatterer, and the list of those near a
/// rough interface (with room for all). Anechoic scatterers are left out.
struct MixedCellHits {
  const MixedCell* const* cells;
  InterfaceHit* hits;
  int hit_count = 0;
};

/// Writes the cells' scatterers within the beam to `projected`, which has room for all of them and
/// kCompactionWidth more, as have the arrays of `cells`. `mixed`: null for homogeneous cells.
/// Returns how many.
int project_scatterers(const HashCellArrays& cells,
                       int count,
                       const CellAxes& axes,
                       const BeamProjection& projection,
                       const ProjectedScatterers& projected,
                       MixedCellHits* mixed = nullptr);

/// A single scatterer, and the row of the beam's table that contains it.
struct PointScatterer {
  BeamVector at;
  float amplitude = 0;
  std::int32_t row = 0;
};
/// Writes the scatterer to `projected` if it is within the beam. Returns 1 if so, else 0.
int project_point(const PointScatterer& point,
                  const BeamProjection& projection,
                  const ProjectedScatterers& projected);

}  // namespace wobblebench::sim
