// Vectorised search for the hash cells of a block that the beam touches.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/optics/beam_table.h"
#include "sim/speckle/scatterers/beam_vector.h"

namespace wobblebench::sim {

enum class CellKind : std::uint8_t;

/// A reach as a parabola over the range: at_face + slope * range + square * range^2 (m).
struct ReachParabola {
  float at_face = 0;
  float slope = 0;
  float square = 0;
};
/// The beam's reach near a block.
struct BlockReach {
  ReachParabola lateral;
  ReachParabola elevation;
};
/// For blocks whose centre lies in each row of the table.
std::vector<BlockReach> reaches_around(const BeamTable& table,
                                       const BeamTable::Direction& lateral,
                                       double block_m);

/// Centres of an octave's hash cells, relative to the low corner of their block.
struct CellCenters {
  const float* axial;
  const float* lateral;
  const float* elevation;
};

/// The bounds against which the hash cells of a block are tested.
struct CellTest {
  BeamVector corner;     ///< of the block
  float half_lateral_m;  ///< half extents of a cell
  float half_elevation_m;
  BlockReach reach;
  float begin_m;  ///< interval of the cells' axial centres
  float end_m;
  BeamRim rim;
};
/// Sets `touched` to 1 for cells that the beam may touch, else to 0.
void test_cells(const CellCenters& centers, int count, const CellTest& test, std::uint8_t* touched);

/// Sets `selected` to 1 for touched cells of one kind, else to 0.
void select_kind(const std::uint8_t* touched,
                 const CellKind* kinds,
                 CellKind wanted,
                 int count,
                 std::uint8_t* selected);

}  // namespace wobblebench::sim
