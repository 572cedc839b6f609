// How strongly tissue echoes at a place, for those who ask for millions of scatterers: tissue at
// rest in parcels of a few millimetres, divided into the scatterers' hash cells. Most hash cells
// are all of one material. Most others are cut by one surface, whose distance within the cell is
// close to a parabola of the place, and known as such. Only the rest asks the tissue map for every
// scatterer.
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
#include "sim/surface_patches.h"

namespace wobblebench::sim {

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

  /// What is known of a hash cell: a material from 0 on; kIntricate: ask amplitude_at(); below
  /// that, patch(code).
  static constexpr int kIntricate = -1;
  int code(const Parcel& parcel, int octave, int cell) const {
    if (parcel.mixed < 0) return parcel.material;
    const auto first = static_cast<std::size_t>(parcel.mixed) * codes_per_parcel_;
    return codes_[first + divisions_[static_cast<std::size_t>(octave)].first + cell];
  }
  const SurfacePatch& patch(int code) const {
    return patches_[static_cast<std::size_t>(kIntricate - 1 - code)];
  }

  float amplitude(phantoms::MaterialIndex material) const {
    return amplitude_[static_cast<std::size_t>(material)];
  }
  /// At a scatterer's place in any hash cell, with the diffuse echo of rough interfaces: a sheet as
  /// thick as the pulse, whose power at its peak is the interface's. `direction`: of the sound, at
  /// rest.
  float amplitude_at(const Parcel& parcel,
                     int octave,
                     int cell,
                     const CellOffset& offset,
                     const glm::vec3& direction) const;
  /// Within the sheet around a patch's surface.
  float sheet_amplitude(const SurfacePatch& patch,
                        const CellOffset& offset,
                        const glm::vec3& direction) const;
  /// Half of that sheet's thickness; 0: interfaces do not echo.
  float half_sheet_m() const { return half_sheet_m_; }

  std::size_t bytes() const;

 private:
  friend class PatchMaker;

  /// Where an octave's hash cells are among a mixed parcel's codes.
  struct Division {
    int cells = 0;  ///< along the side
    int first = 0;
  };
  void tabulate_sheets(const std::vector<phantoms::Material>& materials);
  void find_parcels(int threads);
  void find_codes(int threads);
  float power_at(const glm::dvec3& rest_m, const glm::vec3& direction) const;
  /// `gradient`: of the distance, outwards.
  float sheet_power(phantoms::MaterialIndex inside,
                    phantoms::MaterialIndex outside,
                    const glm::vec3& gradient,
                    const glm::vec3& direction) const;

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
  std::vector<SurfacePatch> patches_;
  std::vector<float> power_;      ///< of each material
  std::vector<float> amplitude_;  ///< of each material
  std::vector<float> sheets_;     ///< power by material before, material behind, cosine
  float half_sheet_m_ = 0;
};

}  // namespace wobblebench::sim
