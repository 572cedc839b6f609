// Echo amplitudes at the scatterers: tissue at rest, divided into blocks of a few millimetres, each
// divided into the scatterers' hash cells. Most hash cells hold one material. For the others the
// material of each scatterer is determined when a beam first touches the block; tissue outside
// every beam is never evaluated.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "phantoms/material.h"
#include "sim/speckle/scatterers/scatterer_cells.h"

namespace wobblebench::sim {

class ProbeOptics;
class TissueMap;
struct ScannedTissue;
struct SimulationOptions;

/// A hash cell whose scatterers lie in several materials, or near a rough interface.
struct MixedCell {
  float amplitude[kScatterersInCell] = {};  ///< 0: anechoic; near a rough interface 1
  std::int32_t first_interface = 0;         ///< index of its first InterfaceScatterer
  std::uint32_t near_interface =
      0;  ///< bit i: scatterer i has an InterfaceScatterer, in this order
};

/// A scatterer that also echoes as part of a rough interface. The interface is represented by a
/// layer as thick as the pulse, whose echo has the energy of a pulse with the interface's power.
struct InterfaceScatterer {
  float power;  ///< echo power of its tissue
  phantoms::MaterialIndex inside;
  phantoms::MaterialIndex outside;
  glm::vec3 outwards;  ///< unit normal
};

/// A rough interface in the direction of propagation.
struct CrossedInterface {
  phantoms::MaterialIndex before = -1;  ///< -1: none
  phantoms::MaterialIndex behind = -1;
};
struct ScattererEcho {
  float amplitude = 0;
  CrossedInterface interface = {};  ///< to which it belongs
};

/// The tissue of a hash cell.
enum class CellKind : std::uint8_t { anechoic, homogeneous, mixed };

/// The hash cells of a mixed block: one with several materials.
struct BlockCells {
  /// All hash cells, octave by octave; see TissueBlocks::code.
  std::vector<std::int16_t> codes;
  std::vector<CellKind> kinds;
  std::vector<MixedCell> cells;
  std::vector<InterfaceScatterer> interfaces;
};

/// Amplitudes are square roots of the mean intensity of a Rayleigh envelope relative to a perfect
/// mirror's, where scatterers of this tissue fill the beam and the pulse.
class TissueBlocks {
 public:
  /// `cells` must outlive it. Const functions may be called from several threads.
  TissueBlocks(const ScannedTissue& tissue,
               const ProbeOptics& optics,
               const SimulationOptions& options,
               const ScattererCells& cells);
  ~TissueBlocks();
  TissueBlocks(const TissueBlocks&) = delete;
  TissueBlocks& operator=(const TissueBlocks&) = delete;

  double side_m() const { return side_m_; }
  const glm::dvec3& origin_m() const { return origin_m_; }  ///< low corner of block (0, 0, 0)
  /// Blocks outside these two are anechoic.
  glm::ivec3 first() const;
  glm::ivec3 last() const;

  struct Block {
    glm::ivec3 index{0};
    phantoms::MaterialIndex material = 0;  ///< of the whole block, if it is not mixed
    const BlockCells* mixed = nullptr;     ///< null: the block is homogeneous
  };
  /// Any index is valid; blocks outside the tissue map are of the background material.
  Block block(const glm::ivec3& index) const;
  /// True if the whole block is anechoic.
  bool anechoic(const Block& block) const {
    return block.mixed == nullptr && amplitude(block.material) == 0;
  }

  /// A hash cell's material, or, if negative, the argument of mixed_cell().
  int code(const Block& block, int octave, int cell) const {
    if (block.mixed == nullptr) return block.material;
    return block.mixed->codes[first_cell(octave) + static_cast<std::size_t>(cell)];
  }
  /// Codes and kinds of an octave's hash cells in a mixed block.
  const std::int16_t* codes(const Block& block, int octave) const {
    return block.mixed->codes.data() + first_cell(octave);
  }
  const CellKind* kinds(const Block& block, int octave) const {
    return block.mixed->kinds.data() + first_cell(octave);
  }
  static const MixedCell& mixed_cell(const Block& block, int code) {
    return block.mixed->cells[static_cast<std::size_t>(-1 - code)];
  }

  float amplitude(phantoms::MaterialIndex material) const {
    return amplitude_[static_cast<std::size_t>(material)];
  }
  /// Echo of a mixed cell's scatterer near a rough interface. `direction`: of propagation, in the
  /// rest frame.
  ScattererEcho interface_echo(const BlockCells& cells,
                               const MixedCell& cell,
                               int scatterer,
                               const glm::vec3& direction) const;
  /// Echo of any scatterer of any hash cell.
  ScattererEcho echo_at(
      const Block& block, int octave, int cell, int scatterer, const glm::vec3& direction) const;

 private:
  friend class BlockCellsBuilder;

  std::size_t first_cell(int octave) const {
    return static_cast<std::size_t>(first_cell_[static_cast<std::size_t>(octave)]);
  }
  void tabulate_interfaces(const std::vector<phantoms::Material>& materials);
  void classify_blocks(int threads);
  const BlockCells& cells_of(int mixed) const;
  float interface_power(const CrossedInterface& crossed, float cosine) const;

  std::shared_ptr<const TissueMap> map_;
  double side_m_ = 0;
  glm::dvec3 origin_m_{0};
  glm::ivec3 blocks_{0};                ///< number along each axis
  phantoms::MaterialIndex background_;  ///< outside the map
  std::vector<std::int32_t> kinds_;     ///< material, or -1 - index in mixed_; x fastest
  std::vector<glm::ivec3> mixed_;       ///< the mixed blocks
  std::vector<int> first_cell_;         ///< of each octave, among a mixed block's codes
  int codes_per_block_ = 0;
  const ScattererCells* scatterer_cells_;
  /// Cells of each mixed block; null until first needed.
  mutable std::vector<std::atomic<const BlockCells*>> mixed_cells_;
  std::vector<float> power_;            ///< of each material
  std::vector<float> amplitude_;        ///< of each material
  std::vector<float> interface_power_;  ///< by material before, material behind, cosine
  float half_layer_m_ = 0;              ///< 0: interfaces do not echo
};

}  // namespace wobblebench::sim
