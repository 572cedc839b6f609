// Tables for the scatterers of one scene: what all sticks share.
#pragma once

#include <limits>
#include <vector>

#include "sim/beam/beam_bounds.h"
#include "sim/scatterers/block_search.h"
#include "sim/scatterers/cell_search.h"
#include "sim/scatterers/range_bins.h"
#include "sim/scatterers/scatterer_cells.h"
#include "sim/scatterers/scatterer_projection.h"
#include "sim/scatterers/scatterer_settings.h"
#include "sim/scatterers/tissue_blocks.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

/// Immutable after construction.
struct ScattererScene {
  ScattererScene(const ScannedTissue& scanned,
                 const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options,
                 const ScattererSettings& settings);

  /// One octave by row of the beam's table.
  struct OctaveGain {
    std::vector<OctaveAtRow> rows;
    /// 1 where scatterers of a block centred in the row may contribute.
    std::vector<char> contributes;
    /// Range interval in which it contributes.
    float begin_m = std::numeric_limits<float>::infinity();
    float end_m = 0;
  };

  ScannedTissue tissue;
  BeamTable table;
  double per_m3;   ///< density of the scatterers of all octaves
  double pulse_m;  ///< integral of the pulse's power over range: its equivalent length
  ScattererCells cells;
  TissueBlocks blocks;
  std::vector<OctaveGain> gains;
  std::vector<BeamAtRow> rows;
  BeamBounds bounds;
  std::vector<BlockReach> reaches;  ///< by the row of a block's centre
  BeamRim rim;
  PulseTaps taps;
  double cycles_per_m;  ///< of range, two-way

  /// `octave`: null for project_point().
  BeamProjection projection(const OctaveGain* octave) const {
    return {rows.data(),
            octave == nullptr ? nullptr : octave->rows.data(),
            table.columns(),
            table.rows() - 1,
            static_cast<float>(table.rows_per_m()),
            rim};
  }
  BlockGrid block_grid() const {
    return {blocks.origin_m(), blocks.side_m(), blocks.first(), blocks.last()};
  }

 private:
  /// `per_cell`: least number of scatterers in each resolution cell.
  void compute_octave_gains(const hw::AcquisitionPlan& plan, double per_cell);
  void tabulate_rows();
};

}  // namespace wobblebench::sim
