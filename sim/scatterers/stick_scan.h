// One stick's search for scatterers: tube, parcels, hash cells, scatterers, echoes.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/scatterers/echo_queue.h"
#include "sim/scatterers/hash_cell_queue.h"
#include "sim/scatterers/scatterer_field.h"
#include "sim/scatterers/scatterer_scene.h"

namespace wobblebench::sim {

/// What a thread works with, reused from stick to stick.
struct ScanBuffers {
  std::vector<TouchedParcel> touched;
  /// Octave by octave: of tissue that moves as one, and of that which bends.
  std::vector<OctaveCells> whole[2], bent;
  /// Of a parcel's cells, and room for what is tested together.
  static constexpr int kFlags = kMostCells + kFlagsTogether;
  std::uint8_t near[kFlags];
  std::uint8_t chosen[kFlags];
  std::int32_t list[kFlags];
  std::vector<SheetHit> hits;
  EchoQueue echoes;
};

class StickScan {
 public:
  StickScan(const ScattererScene& scene, const StickPath& way, ScanBuffers& buffers);

  /// Adds the stick's echoes to `iq`. Returns how many scatterers contributed.
  std::uint64_t run(std::span<std::complex<float>> iq);
  /// The same for given scatterers alone.
  std::uint64_t run(std::span<const PointEcho> points, std::span<std::complex<float>> iq);

 private:
  /// A parcel as it is now.
  struct Parcel {
    TissueParcels::Parcel tissue;
    RestToBeam map;
    bool bent = false;     ///< has a map of its own …
    bool straight = true;  ///< … that is good for all of it
    glm::dvec3 corner;     ///< low corner, at rest
    BeamVector beam_corner;
    glm::vec3 direction;  ///< of the sound, at rest
    ParcelReach reach;
    std::uint32_t key = 0;  ///< of the octave at hand
  };

  /// Once there is something to hear.
  void begin();
  void fill_grids(const RestToBeam& map, std::vector<OctaveCells>& octaves) const;
  void scan(const TouchedParcel& touched, const TissueParcels::Parcel& tissue);
  /// The cells of a parcel; finds out how it moves.
  std::vector<OctaveCells>& place_parcel(const glm::dvec3& center, Parcel& parcel);
  void scan_octave(Parcel& parcel, OctaveCells& cells, int octave);
  CellTest cell_test(const Parcel& parcel, const CellGrid& grid, int octave) const;
  /// Writes the listed cells, but for their amplitudes.
  void place_cells(const Parcel& parcel,
                   const CellGrid& grid,
                   int count,
                   const TouchedHashCells& to) const;
  /// Lists those of the cells that are near and of one kind. Returns how many.
  int list_near(const Parcel& parcel, int octave, int count, CellKind wanted);
  void take_even_cells(const Parcel& parcel, int octave, OctaveCells& cells);
  void take_mixed_cells(const Parcel& parcel, int octave, OctaveCells& cells);
  void take_bent_cells(const Parcel& parcel, OctaveCells& cells, int octave);
  HashAxes place_bent(const Parcel& parcel, int octave, int number, CellOrigin& origin) const;
  /// Looks at the scatterers of the cells that wait. `direction`: of the sound, at rest.
  void see_even(HashCellQueue& batch, const HashAxes& axes, int octave);
  void see_mixed(HashCellQueue& batch,
                 const HashAxes& axes,
                 int octave,
                 const glm::vec3& direction);
  void see_rest();

  const ScattererScene& scene_;
  const StickPath& way_;
  ScanBuffers& buffers_;
  StickView view_;
  double end_m_;            ///< true range of the farthest echo
  glm::vec3 direction_[2];  ///< of the sound, at rest, where tissue moves as one
  bool begun_ = false;
};

}  // namespace wobblebench::sim
