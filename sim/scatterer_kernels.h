// The loops that millions of scatterers pass through, written so that compilers make them wide.
// Positions are floats in beam coordinates: metres along the stick, to the side in the image plane,
// and across it. A float's last digit is 1e-8 m there, 1e-4 of a cycle.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/lane_pack.h"
#include "sim/scatterer_cells.h"
#include "sim/simd.h"
#include "sim/tissue_parcels.h"

namespace wobblebench::sim {

/// Metres along three axes.
struct BeamVector {
  float axial = 0;
  float lateral = 0;
  float elevation = 0;
};

/// The beam for hash cells whose middle lies nearest to one row of its table. A bend is
/// bend + slope * axial, lateness too; columns are those of the table.
struct BeamAtRow {
  float lateral_columns_per_m = 0;
  float elevation_columns_per_m = 0;
  float late_m = 0;
  float late_slope = 0;
  float lateral_bend_per_m = 0;
  float lateral_slope_per_m2 = 0;
  float elevation_bend_per_m = 0;
  float elevation_slope_per_m2 = 0;
  float scale = 1;  ///< of the beam's sections there (sim/beam_sections.h)
};

/// What one hash unit along each of the tissue's axes is in beam coordinates.
struct HashAxes {
  BeamVector x;
  BeamVector y;
  BeamVector z;
};

/// What a scatterer puts into the bin that its echo falls into; see sim/echo_bins.h.
struct alignas(16) BinShare {
  float low_re;
  float low_im;
  float high_re;
  float high_im;
};

/// Where the beam ends: at an ellipse through the last columns, or, for side lobes, where the sum
/// of both columns reaches the last.
enum class BeamRim { ellipse, diamond };

/// What all scatterers of a stick and an octave share.
struct Sight {
  const BeamAtRow* rows;
  std::int32_t columns;  ///< of the beam's table
  BeamRim rim;
  const float* gain;  ///< [row][scatterer of a cell]; not looked at for given places
};

/// Writes the cells' scatterers within reach to `seen`, which has room for all of them and one cell
/// more. Returns how many.
int see_scatterers(const TouchedHashCells& cells,
                   int count,
                   const HashAxes& axes,
                   const Sight& sight,
                   const SeenScatterers& seen);

/// Scatterers at given places, each with the nearest row of the beam's table.
struct BeamPlace {
  BeamVector at;
  float amplitude = 0;
  std::int32_t row = 0;
};
int see_places(const BeamPlace* places, int count, const Sight& sight, const SeenScatterers& seen);

/// A scatterer whose amplitude depends on the direction of the sound.
struct SheetHit {
  std::int32_t seen;       ///< its place in `seen`
  std::int32_t cell;       ///< of those given
  std::int32_t scatterer;  ///< in its cell
};

/// The same for mixed cells, whose silent scatterers are left out. Writes those that lie in sheets
/// to `hits` too (room for all), and their number to `hit_count`.
int see_mixed_scatterers(const TouchedHashCells& cells,
                         const MixedCell* const* mixed,
                         int count,
                         const HashAxes& axes,
                         const Sight& sight,
                         const SeenScatterers& seen,
                         SheetHit* hits,
                         int* hit_count);

/// An octave's hash cells in a parcel, from its low corner: their centres and low corners.
struct CellPlaces {
  const float* axial;
  const float* lateral;
  const float* elevation;
  const float* corner_axial;
  const float* corner_lateral;
  const float* corner_elevation;
};
/// The beam's reach around a parcel: parabolas over the way along the stick.
struct ReachAlong {
  float at = 0;
  float slope = 0;
  float square = 0;
};
struct ParcelReach {
  ReachAlong lateral_m;
  ReachAlong elevation_m;
};
/// What an octave's hash cells in a parcel are tested against.
struct CellTest {
  BeamVector corner;     ///< the parcel's
  BeamVector half_cell;  ///< half extents of a cell
  ParcelReach reach;
  float rows_per_m;  ///< of the beam's table
  std::int32_t last_row;
  std::int32_t first_heard;  ///< rows between which the octave is not silent
  std::int32_t last_heard;
  std::uint32_t parcel_key;
  BeamRim rim;
};
/// Tests the hash cells of a parcel: those that the beam may touch are near.
void test_cells(const CellPlaces& places, int count, const CellTest& test, TestedCells& tested);

/// Leaves 1 of the flags of hash cells only where they are of one kind.
void choose_kind(const std::uint8_t* near,
                 const CellKind* kinds,
                 CellKind wanted,
                 int count,
                 std::uint8_t* chosen);

struct EchoConstants {
  const std::uint32_t* beam;  ///< words of the sections
  float cycles_per_m;         ///< of path: 2 f0 / c
  float bins_per_m;
  std::int32_t last_bin;  ///< what lies beyond it, and what lies before range 0, falls into the
                          ///< last and the first bin, which nobody reads
  float colour_per_bin;   ///< 1 / (2 k0 * bin)
};

/// Echoes are made at most this many at a time.
inline constexpr int kEchoBatch = 256;

/// The echoes of at most kEchoBatch scatterers: shares and the bins that they belong to; bin 1
/// begins at range 0.
void make_echoes(const SeenScatterers& seen,
                 int count,
                 const EchoConstants& constants,
                 BinShare* shares,
                 std::int32_t* bins);

/// bins[at[i]] += shares[i], in this order.
void deposit(const BinShare* shares, const std::int32_t* at, int count, BinShare* bins);

/// sums[m] += sum over taps of taps[t] * values[m + t].
void smooth(const float* values, const float* taps, int tap_count, int count, float* sums);

}  // namespace wobblebench::sim
