// How strongly tissue echoes at a scatterer's place, for those who ask for millions of them: tissue
// at rest in parcels of a few millimetres, divided into the scatterers' hash cells. Most hash cells
// hold one material. For the others each scatterer's material is found once, when a beam first
// comes near: tissue outside every beam is never visited.
#pragma once

#include <atomic>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"
#include "sim/scatterers/scatterer_cells.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

/// A hash cell whose scatterers lie in several materials, or near a rough interface.
struct MixedCell {
  float amplitude[kScatterersInCell] = {};  ///< 0: silent; of those in sheets: any but 0
  std::int32_t first_sheet = 0;             ///< of its scatterers that lie in sheets, in order …
  std::uint32_t in_sheet = 0;               ///< … which these bits name
};

/// A scatterer that also echoes as part of a rough interface: of a sheet as thick as the pulse,
/// whose echo has the energy of a pulse with the interface's power.
struct SheetScatterer {
  float power;  ///< of its tissue
  phantoms::MaterialIndex inside;
  phantoms::MaterialIndex outside;
  glm::vec3 outwards;  ///< unit normal
};

/// How a hash cell echoes.
enum class CellKind : std::uint8_t { silent, even, mixed };

/// What is known of a parcel that holds several materials.
struct ParcelCells {
  /// Of all hash cells, octave by octave; see TissueParcels::code.
  std::vector<std::int16_t> codes;
  std::vector<CellKind> kinds;
  std::vector<MixedCell> cells;
  std::vector<SheetScatterer> sheets;
};

/// Echoes are roots of relative powers, those of a Rayleigh envelope: of its mean intensity where
/// the beam and the pulse are full of such scatterers.
class TissueParcels {
 public:
  /// `cells` must outlive it. Const functions may be called from several threads.
  TissueParcels(const ScannedTissue& subject,
                const hw::AcquisitionPlan& plan,
                const SimulationOptions& options,
                const ScattererCells& cells);
  ~TissueParcels();
  TissueParcels(const TissueParcels&) = delete;
  TissueParcels& operator=(const TissueParcels&) = delete;

  double side_m() const { return side_m_; }
  const glm::dvec3& origin_m() const { return origin_m_; }  ///< low corner of parcel (0, 0, 0)
  /// Parcels beyond these two do not echo.
  glm::ivec3 first() const;
  glm::ivec3 last() const;

  /// One parcel; there are parcels everywhere, also outside the tissue map.
  struct Parcel {
    glm::ivec3 index{0};
    phantoms::MaterialIndex material = 0;  ///< of all of it, if it is not mixed
    const ParcelCells* mixed = nullptr;    ///< what a mixed parcel holds
  };
  Parcel parcel(const glm::ivec3& index) const;
  /// Nothing in it echoes.
  bool silent(const Parcel& parcel) const {
    return parcel.mixed == nullptr && amplitude(parcel.material) == 0;
  }

  /// What is known of a hash cell: its material, or below 0 mixed_cell(parcel, code).
  int code(const Parcel& parcel, int octave, int cell) const {
    if (parcel.mixed == nullptr) return parcel.material;
    return parcel.mixed->codes[first_cell(octave) + static_cast<std::size_t>(cell)];
  }
  /// An octave's hash cells in a mixed parcel.
  const std::int16_t* codes(const Parcel& parcel, int octave) const {
    return parcel.mixed->codes.data() + first_cell(octave);
  }
  const CellKind* kinds(const Parcel& parcel, int octave) const {
    return parcel.mixed->kinds.data() + first_cell(octave);
  }
  static const MixedCell& mixed_cell(const Parcel& parcel, int code) {
    return parcel.mixed->cells[static_cast<std::size_t>(-1 - code)];
  }

  float amplitude(phantoms::MaterialIndex material) const {
    return amplitude_[static_cast<std::size_t>(material)];
  }
  /// Of a mixed cell's scatterer that lies in a sheet. `direction`: of the sound, at rest.
  float sheet_amplitude(const ParcelCells& cells,
                        const MixedCell& cell,
                        int scatterer,
                        const glm::vec3& direction) const;
  /// Of any hash cell's scatterer.
  float amplitude_at(
      const Parcel& parcel, int octave, int cell, int scatterer, const glm::vec3& direction) const;

 private:
  friend class CellMaker;

  /// Where an octave's hash cells are among a mixed parcel's codes.
  struct Division {
    int cells = 0;  ///< along the side
    int first = 0;
  };
  std::size_t first_cell(int octave) const {
    return static_cast<std::size_t>(divisions_[static_cast<std::size_t>(octave)].first);
  }
  void tabulate_sheets(const std::vector<phantoms::Material>& materials);
  void find_parcels(int threads);
  const ParcelCells& cells_of(int mixed) const;
  float sheet_power(const SheetScatterer& sheet, const glm::vec3& direction) const;

  std::shared_ptr<const TissueMap> map_;
  double side_m_ = 0;
  glm::dvec3 origin_m_{0};
  glm::ivec3 parcels_{0};
  phantoms::MaterialIndex background_;  ///< beyond the map
  std::vector<std::int32_t> kinds_;     ///< material, or -1 - number of the mixed parcel; x fastest
  std::vector<glm::ivec3> mixed_;
  std::vector<Division> divisions_;
  int codes_per_parcel_ = 0;
  const ScattererCells* processes_;
  /// Of each mixed parcel, once somebody has asked for it.
  mutable std::vector<std::atomic<const ParcelCells*>> known_;
  std::vector<float> power_;      ///< of each material
  std::vector<float> amplitude_;  ///< of each material
  std::vector<float> sheets_;     ///< power by material before, material behind, cosine
  float half_sheet_m_ = 0;        ///< 0: interfaces do not echo
};

}  // namespace wobblebench::sim
