// Hash cells in beam coordinates: those of a block, and queues of those whose scatterers are to be
// projected together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/speckle/scatterers/cell_search.h"
#include "sim/speckle/scatterers/scatterer_projection.h"
#include "sim/tissue/stick_transform.h"

namespace wobblebench::sim {

struct BlockCells;

BeamVector to_float(const glm::dvec3& v);
/// Hash units of cells of this size in beam coordinates, by a map that holds there.
HashAxes hash_axes(const RestToBeam& map, double cell_m);
/// Origin of a hash cell's scatterers. `low_corner_m`: at rest, or relative to a block's corner if
/// the map has no shift.
CellOrigin cell_origin(const RestToBeam& map, const glm::dvec3& low_corner_m, double cell_m);

/// An octave's hash cells in a block, in beam coordinates relative to the block's low corner.
/// Padded to a multiple of kCompactionWidth with cells outside every beam.
struct CellGrid {
  std::vector<float> axial, lateral, elevation;  ///< centres
  std::vector<CellOrigin> origins;
  HashAxes axes;
  BeamVector half;  ///< half extents of a cell

  void fill(const RestToBeam& map, double side_m, int divisions);
  int count() const { return static_cast<int>(axial.size()); }
  CellCenters centers() const { return {axial.data(), lateral.data(), elevation.data()}; }
};

/// Hash cells, of several blocks, that are projected together.
class HashCellQueue {
 public:
  /// Memory behind the queued cells for `more` and kCompactionWidth more.
  HashCellArrays reserve(std::size_t more);
  /// The queued cells.
  HashCellArrays cells();

  std::size_t count = 0;
  std::vector<const MixedCell*> mixed;    ///< in a queue of mixed cells: each cell …
  std::vector<const BlockCells*> blocks;  ///< … and its block's cells

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
