// One stick's search for scatterers: tube, parcels, hash cells, scatterers, echoes.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/echo_bins.h"
#include "sim/scatterers.h"

namespace wobblebench::sim {

/// An octave's hash cells in a parcel, in beam coordinates.
struct CellGrid {
  /// Centres and low corners, from the parcel's low corner.
  std::vector<float> axial, lateral, elevation;
  std::vector<BeamVector> corner;
  HashAxes axes;
  BeamVector half;  ///< half extents of a cell

  void fill(const RestToBeam& map, double side_m, int divisions);
};

/// Hash cells that are looked at together.
struct CellBatch {
  std::vector<TouchedHashCell> cells;
  std::vector<const MixedCell*> mixed;  ///< of mixed cells

  void clear();
};

/// What a thread works with, reused from stick to stick.
struct ScanBuffers {
  std::vector<TouchedParcel> touched;
  std::vector<CellGrid> grids;
  std::vector<std::uint8_t> near;
  std::vector<std::int32_t> list;
  CellBatch even, mixed;
  std::vector<float> path_m;
  std::vector<std::int32_t> entry;
  std::vector<float> amplitude;
  std::vector<SheetHit> hits;
  std::vector<float> delay_m;
  EchoBins bins;
};

class StickScan {
 public:
  StickScan(const ScattererScene& scene, const StickWay& way, ScanBuffers& buffers);

  /// Adds the stick's echoes to `iq`. Returns how many scatterers contributed.
  std::uint64_t run(std::span<std::complex<float>> iq);
  /// The same for given scatterers alone.
  std::uint64_t run(std::span<const PointEcho> points, std::span<std::complex<float>> iq);

 private:
  /// A parcel as it is now.
  struct Parcel {
    TissueParcels::Parcel tissue;
    RestToBeam map;
    bool straight = true;  ///< the map is good for all of it
    glm::dvec3 corner;     ///< low corner, at rest
    BeamVector beam_corner;
    glm::vec3 direction;  ///< of the sound, at rest
    ParcelReach reach;
    std::uint32_t key = 0;  ///< of the octave at hand
  };

  void scan(const TouchedParcel& touched);
  ParcelReach reach_around(double range_m) const;
  void scan_octave(Parcel& parcel, const CellGrid& grid, int octave);
  TouchedHashCell touched_cell(const Parcel& parcel, const CellGrid& grid, int number) const;
  /// Those of the first `count` hash cells that are near.
  std::span<const std::int32_t> list_near(int count);
  void take_near_cells(
      const Parcel& parcel, const CellGrid& grid, int octave, int first, int count);
  void take_even_cells(
      const Parcel& parcel, const CellGrid& grid, int octave, int first, std::span<const std::int32_t> near);
  void sort_cell(const Parcel& parcel, const TouchedHashCell& cell, int code);
  HashAxes place_bent(const Parcel& parcel, int octave, int number, TouchedHashCell& cell) const;
  void see(const Parcel& parcel, const HashAxes& axes);
  void see_even(const HashAxes& axes);
  void see_mixed(const Parcel& parcel, const HashAxes& axes);
  SeenScatterers room_for(std::size_t cells);
  void flush();
  void delay_paths();
  void find_delays();

  const ScattererScene& scene_;
  const StickWay& way_;
  ScanBuffers& buffers_;
  StickView view_;
  double heard_m_;  ///< apparent range of the farthest echo
  double end_m_;    ///< its true range
  std::size_t pending_ = 0;
  std::uint64_t total_ = 0;
};

}  // namespace wobblebench::sim
