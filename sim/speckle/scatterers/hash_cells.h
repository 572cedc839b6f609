// Hash cells in beam coordinates: the grid of a block's cells, the vectorised search for those that
// the beam touches, and queues of cells whose scatterers are projected together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/optics/beam_table.h"
#include "sim/speckle/scatterers/scatterer_projection.h"
#include "sim/tissue/scanned_tissue.h"

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
/// The reach for blocks whose centre lies in a row, for each row of the table.
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

struct BlockCells;

BeamVector to_float(const glm::dvec3& v);
/// Hash units of cells of this size in beam coordinates, by a map that is valid there.
HashAxes hash_axes(const RestToBeam& map, double cell_m);
/// Origin of a hash cell's scatterers. `low_corner_m`: at rest.
CellOrigin cell_origin(const RestToBeam& map, const glm::dvec3& low_corner_m, double cell_m);

/// An octave's hash cells in a block, in beam coordinates relative to the block's low corner.
/// Padded to a multiple of kCompactionWidth with cells outside every beam.
struct CellGrid {
  std::vector<float> axial, lateral, elevation;  ///< centres
  std::vector<CellOrigin> origins;
  HashAxes axes;
  BeamVector half;  ///< half extents of a cell

  /// The cells of a block of this side.
  void fill(const RestToBeam& map, double side_m, int divisions);
  int count() const { return static_cast<int>(axial.size()); }
  CellCenters centers() const { return {axial.data(), lateral.data(), elevation.data()}; }

 private:
  void number_cells(int divisions);

  int divisions_ = 0;
  std::vector<float> x_, y_, z_;  ///< of the centres, at rest, in cells
};

/// Hash cells, of several blocks, that are projected together.
class HashCellQueue {
 public:
  /// Memory behind the queued cells for `more` cells, plus kCompactionWidth.
  HashCellArrays reserve(std::size_t more);
  /// The queued cells.
  HashCellArrays cells();

  std::size_t count = 0;
  std::vector<const MixedCell*> mixed;    ///< of each cell, in a queue of mixed cells
  std::vector<const BlockCells*> blocks;  ///< the cells of its block, likewise
  std::vector<HashAxes> axes;             ///< of each cell, where each has its own
  std::vector<glm::vec3> directions;      ///< of the sound at each cell, at rest, likewise

 private:
  std::vector<CellOrigin> origin_;
  std::vector<std::uint32_t> seed_;
  std::vector<float> amplitude_;
};

/// An octave's hash cells under one map, and the queues of those that the beam touches.
struct OctaveCells {
  CellGrid grid;
  HashCellQueue homogeneous, mixed;
};

}  // namespace wobblebench::sim
