// How strongly tissue echoes at a scatterer's place, for those who ask for millions of them: tissue
// at rest in parcels of a few millimetres, divided into the scatterers' hash cells. Most hash cells
// hold one material. For the others each scatterer's material is found once, when the scene is
// made.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "hw/acquisition_plan.h"
#include "sim/options.h"
#include "sim/scatterer_cells.h"
#include "sim/subject.h"

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

/// Echoes are roots of relative powers, those of a Rayleigh envelope: of its mean intensity where
/// the beam and the pulse are full of such scatterers.
class TissueParcels {
 public:
  TissueParcels(const Subject& subject,
                const hw::AcquisitionPlan& plan,
                const SimulationOptions& options,
                const ScattererCells& cells);

  double side_m() const { return side_m_; }
  const glm::dvec3& origin_m() const { return origin_m_; }  ///< low corner of parcel (0, 0, 0)

  /// One parcel; there are parcels everywhere, also outside the tissue map.
  struct Parcel {
    glm::ivec3 index{0};
    phantoms::MaterialIndex material = 0;  ///< of all of it, if it is not mixed
    int mixed = -1;                        ///< number of a mixed parcel
  };
  Parcel parcel(const glm::ivec3& index) const;
  /// Nothing in it echoes.
  bool silent(const Parcel& parcel) const {
    return parcel.mixed < 0 && amplitude(parcel.material) == 0;
  }

  /// What is known of a hash cell: its material, or below 0 mixed_cell(code).
  int code(const Parcel& parcel, int octave, int cell) const {
    if (parcel.mixed < 0) return parcel.material;
    const auto first = static_cast<std::size_t>(parcel.mixed) * codes_per_parcel_;
    return codes_[first + divisions_[static_cast<std::size_t>(octave)].first + cell];
  }
  const MixedCell& mixed_cell(int code) const {
    return cells_[static_cast<std::size_t>(-1 - code)];
  }

  float amplitude(phantoms::MaterialIndex material) const {
    return amplitude_[static_cast<std::size_t>(material)];
  }
  /// Of a mixed cell's scatterer that lies in a sheet. `direction`: of the sound, at rest.
  float sheet_amplitude(const MixedCell& cell, int scatterer, const glm::vec3& direction) const;
  /// Of any hash cell's scatterer.
  float amplitude_at(
      const Parcel& parcel, int octave, int cell, int scatterer, const glm::vec3& direction) const;

  std::size_t bytes() const;

 private:
  friend class CellMaker;

  /// Where an octave's hash cells are among a mixed parcel's codes.
  struct Division {
    int cells = 0;  ///< along the side
    int first = 0;
  };
  void tabulate_sheets(const std::vector<phantoms::Material>& materials);
  void find_parcels(int threads);
  void find_codes(const ScattererCells& cells, int threads);
  float sheet_power(const SheetScatterer& sheet, const glm::vec3& direction) const;

  std::shared_ptr<const TissueMap> map_;
  double side_m_ = 0;
  glm::dvec3 origin_m_{0};
  glm::ivec3 parcels_{0};
  phantoms::MaterialIndex background_;  ///< beyond the map
  std::vector<std::int32_t> kinds_;     ///< material, or -1 - number of the mixed parcel; x fastest
  std::vector<glm::ivec3> mixed_;
  std::vector<Division> divisions_;
  std::size_t codes_per_parcel_ = 0;
  std::vector<std::int32_t> codes_;
  std::vector<MixedCell> cells_;
  std::vector<SheetScatterer> scatterers_in_sheets_;
  std::vector<float> power_;      ///< of each material
  std::vector<float> amplitude_;  ///< of each material
  std::vector<float> sheets_;     ///< power by material before, material behind, cosine
  float half_sheet_m_ = 0;        ///< 0: interfaces do not echo
};

}  // namespace wobblebench::sim
