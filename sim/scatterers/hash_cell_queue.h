// Hash cells on their way from the search for them to a look at their scatterers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/beam/beam_bounds.h"
#include "sim/scatterers/cell_search.h"
#include "sim/scatterers/scatterer_projection.h"

namespace wobblebench::sim {

/// Rounds to floats.
BeamVector narrow(const glm::dvec3& v);
/// Of hash cells of this size, by a map that is good there.
HashAxes hash_axes(const RestToBeam& map, double cell_m);
/// Where a hash cell's scatterers count from. `low_corner_m`: at rest, or from a parcel's corner by
/// a map without a shift.
CellOrigin cell_origin(const RestToBeam& map, const glm::dvec3& low_corner_m, double cell_m);
/// A hash cell's place in its parcel, in cells.
glm::dvec3 cell_place(int number, int divisions);

/// An octave's hash cells in a parcel, in beam coordinates from its low corner. Behind them, up to
/// a multiple of what is tested together, come some that no beam touches.
struct CellGrid {
  std::vector<float> axial, lateral, elevation;  ///< middles
  std::vector<CellOrigin> origins;
  HashAxes axes;
  BeamVector half;  ///< half extents of a cell

  void fill(const RestToBeam& map, double side_m, int divisions);
  int count() const { return static_cast<int>(axial.size()); }
  CellMiddles middles() const { return {axial.data(), lateral.data(), elevation.data()}; }
};

/// Hash cells that are looked at together.
class HashCellQueue {
 public:
  /// Where the next cells go, and room for some more of them.
  TouchedHashCells next(std::size_t more);
  /// Where those so far are.
  TouchedHashCells cells();

  std::size_t count = 0;
  std::vector<const MixedCell*> mixed;      ///< of mixed cells …
  std::vector<const ParcelCells*> parcels;  ///< … and what holds them

 private:
  std::vector<CellOrigin> origin_;
  std::vector<std::uint32_t> seed_;
  std::vector<float> amplitude_;
};

/// An octave's cells in tissue of one map, and those that wait to be looked at.
struct OctaveCells {
  CellGrid grid;
  HashCellQueue even, mixed;
};

}  // namespace wobblebench::sim
