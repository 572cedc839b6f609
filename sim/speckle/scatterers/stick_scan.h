// Computes the echoes of one stick, from the blocks of tissue within the beam's bounds to hash
// cells, scatterers and range bins.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/speckle/scatterers/echo_queue.h"
#include "sim/speckle/scatterers/hash_cells.h"
#include "sim/speckle/scatterers/scatterer_field.h"
#include "sim/speckle/scatterers/scatterer_scene.h"
#include "sim/speckle/scatterers/stream_compaction.h"

namespace wobblebench::sim {

/// Working memory of one thread, reused from stick to stick.
struct ScanBuffers {
  std::vector<TouchedBlock> blocks;
  /// By octave. `rigid`: tissue that rests, tissue that turns as a whole; `deforming`: the current
  /// block of tissue that moves non-rigidly.
  std::vector<OctaveCells> rigid[2], deforming;
  /// One flag for each hash cell of a block, and padding.
  static constexpr int kFlags = kMaxCells + kCompactionWidth;
  std::uint8_t touched[kFlags];
  std::uint8_t selected[kFlags];
  std::int32_t list[kFlags];  ///< numbers of the current cells
  std::vector<InterfaceHit> hits;
  EchoQueue echoes;
};

class StickScan {
 public:
  StickScan(const ScattererScene& scene, const StickPath& path, ScanBuffers& buffers);

  /// Adds the stick's echoes to `iq`. Returns how many scatterers contributed.
  std::uint64_t run(std::span<std::complex<float>> iq);
  /// The same for given scatterers alone.
  std::uint64_t run(std::span<const PointEcho> points, std::span<std::complex<float>> iq);

 private:
  /// A block of tissue at the stick's time.
  struct Block {
    TissueBlocks::Block tissue;
    RestToBeam map;
    bool deforms = false;  ///< moves non-rigidly and has its own map
    bool linear = true;    ///< that map is accurate in the whole block
    glm::dvec3 corner;     ///< low corner, at rest
    BeamVector beam_corner;
    glm::vec3 direction;  ///< of the sound, at rest
    BlockReach reach;
    std::uint32_t key = 0;  ///< of the current octave
  };

  /// Prepares the buffers, when the first block has been found.
  void begin();
  void fill_grids(const RestToBeam& map, std::vector<OctaveCells>& octaves) const;
  void scan(const TouchedBlock& touched, const TissueBlocks::Block& tissue);
  /// Sets the block's map, and returns the hash cells under it.
  std::vector<OctaveCells>& locate_block(const glm::dvec3& center,
                                         phantoms::Deformation::Turn turn,
                                         Block& block);
  void scan_octave(Block& block, OctaveCells& cells, int octave);
  CellTest cell_test(const Block& block, const CellGrid& grid, int octave) const;
  /// Writes origins and seeds of the listed cells.
  void write_cells(const Block& block,
                   const CellGrid& grid,
                   int count,
                   const HashCellArrays& to) const;
  /// Lists the touched cells of one kind. Returns how many.
  int list_touched(const Block& block, int octave, int count, CellKind wanted);
  void queue_homogeneous_cells(const Block& block, int octave, OctaveCells& cells);
  void queue_mixed_cells(const Block& block, int octave, OctaveCells& cells);
  /// Queues the cells of a block that moves non-rigidly, each with its own axes and direction.
  void queue_deforming_cells(const Block& block, int octave, OctaveCells& cells);
  HashAxes locate_deforming_cell(const Block& block,
                                 int octave,
                                 int number,
                                 CellOrigin& origin) const;
  /// Project the queued cells; project() those of queues that hold `enough`. `direction`: of the
  /// sound, at rest; null: each cell has its own, and its own axes.
  void project(OctaveCells& cells, int octave, std::size_t enough, const glm::vec3* direction);
  static CellAxes axes_of(const OctaveCells& cells,
                          const HashCellQueue& queue,
                          const glm::vec3* direction);
  void project_homogeneous(HashCellQueue& queue, const CellAxes& axes, int octave);
  void project_mixed(HashCellQueue& queue,
                     const CellAxes& axes,
                     int octave,
                     const glm::vec3* direction);
  /// Projects the cells that are still queued.
  void project_pending();

  const ScattererScene& scene_;
  const StickPath& path_;
  ScanBuffers& buffers_;
  const StickBeam& beam_;
  StickTransform transform_;
  double end_m_;            ///< true range of the farthest echo
  glm::vec3 direction_[2];  ///< of the sound, at rest, as ScanBuffers::rigid
  bool begun_ = false;
};

}  // namespace wobblebench::sim
