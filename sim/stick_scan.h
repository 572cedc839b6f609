// One stick's search for scatterers: tube, parcels, hash cells, scatterers, echoes.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/echo_bins.h"
#include "sim/lane_pack.h"
#include "sim/scatterers.h"

namespace wobblebench::sim {

/// An octave's hash cells in a parcel, in beam coordinates from its low corner. Behind them, up to
/// a multiple of what is tested together, come some that no beam touches.
struct CellGrid {
  std::vector<float> axial, lateral, elevation;  ///< centres
  std::vector<float> corner_axial, corner_lateral, corner_elevation;
  HashAxes axes;
  BeamVector half;  ///< half extents of a cell

  void fill(const RestToBeam& map, double side_m, int divisions);
  int count() const { return static_cast<int>(axial.size()); }
  CellPlaces places() const {
    return {axial.data(),
            lateral.data(),
            elevation.data(),
            corner_axial.data(),
            corner_lateral.data(),
            corner_elevation.data()};
  }
};

/// Hash cells that are looked at together.
class CellBatch {
 public:
  /// Where the next cells go, and room for some more of them.
  TouchedHashCells next(std::size_t more);
  /// Where those so far are.
  TouchedHashCells cells();

  std::size_t count = 0;
  std::vector<const MixedCell*> mixed;  ///< of mixed cells

 private:
  std::vector<float> axial_, lateral_, elevation_, amplitude_;
  std::vector<std::uint32_t> key_;
  std::vector<std::int32_t> row_;
};

/// What a thread works with, reused from stick to stick.
struct ScanBuffers {
  std::vector<TouchedParcel> touched;
  /// Octave by octave: of tissue that moves as one, and of that which bends.
  std::vector<CellGrid> grids[2], bent;
  TestedCells tested;
  std::uint8_t chosen[TestedCells::kCount];
  std::int32_t list[TestedCells::kCount];
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

  void fill_grids(const RestToBeam& map, std::vector<CellGrid>& grids) const;
  void scan(const TouchedParcel& touched);
  /// The cells of a parcel; finds out how it moves.
  std::vector<CellGrid>& place_parcel(const glm::dvec3& center, Parcel& parcel);
  ParcelReach reach_around(double range_m) const;
  void scan_octave(Parcel& parcel, const CellGrid& grid, int octave);
  CellTest cell_test(const Parcel& parcel, const CellGrid& grid, int octave) const;
  /// Those of the tested cells that are near and of one kind.
  const std::uint8_t* choose(const Parcel& parcel, int octave, int count, CellKind wanted);
  void take_near_cells(const Parcel& parcel, int octave, int count);
  void take_even_cells(const Parcel& parcel, int octave, int count);
  void take_mixed_cells(const Parcel& parcel, int octave, int count);
  void take_bent_cells(const Parcel& parcel, int octave, int count);
  HashAxes place_bent(const Parcel& parcel,
                      int octave,
                      int number,
                      const TouchedHashCells& cell) const;
  void see(const Parcel& parcel, const HashAxes& axes, int octave);
  void see_even(const HashAxes& axes, const Sight& sight);
  void see_mixed(const Parcel& parcel, const HashAxes& axes, const Sight& sight);
  SeenScatterers room_for(std::size_t cells);
  void flush();
  void delay_paths();
  void find_delays();

  const ScattererScene& scene_;
  const StickWay& way_;
  ScanBuffers& buffers_;
  StickView view_;
  double heard_m_;          ///< apparent range of the farthest echo
  double end_m_;            ///< its true range
  glm::vec3 direction_[2];  ///< of the sound, at rest, where tissue moves as one
  std::size_t pending_ = 0;
  std::uint64_t total_ = 0;
};

}  // namespace wobblebench::sim
