// Which of a parcel's hash cells the beam touches, in loops that compilers make wide.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/beam/beam_table.h"
#include "sim/beam/beam_vector.h"
#include "sim/tissue/tissue_parcels.h"

namespace wobblebench::sim {

/// A parabola over the range.
struct ReachAlong {
  float at_face = 0;
  float slope = 0;
  float square = 0;
};
/// The beam's reach around a parcel (m).
struct ParcelReach {
  ReachAlong lateral;
  ReachAlong elevation;
};
/// For parcels with their middle in each row of the table.
std::vector<ParcelReach> reaches_around(const BeamTable& table, double parcel_m);

/// The middles of an octave's hash cells, from their parcel's low corner.
struct CellMiddles {
  const float* axial;
  const float* lateral;
  const float* elevation;
};

/// What the hash cells of a parcel are tested against.
struct CellTest {
  BeamVector corner;     ///< the parcel's
  float half_lateral_m;  ///< half extents of a cell
  float half_elevation_m;
  ParcelReach reach;
  float begin_m;  ///< ranges between which cells have their middle
  float end_m;
  BeamRim rim;
};
/// `near` is 1 for those that the beam may touch, else 0.
void test_cells(const CellMiddles& middles, int count, const CellTest& test, std::uint8_t* near);

/// Leaves 1 of the flags of hash cells only where they are of one kind.
void choose_kind(const std::uint8_t* near,
                 const CellKind* kinds,
                 CellKind wanted,
                 int count,
                 std::uint8_t* chosen);

}  // namespace wobblebench::sim
