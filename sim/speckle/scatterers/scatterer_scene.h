// Tables for the scatterers of one scene: what all sticks share.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "hw/probe/probe.h"
#include "sim/optics/beam_bounds.h"
#include "sim/optics/beam_profile.h"
#include "sim/speckle/scatterers/block_search.h"
#include "sim/speckle/scatterers/cell_search.h"
#include "sim/speckle/scatterers/range_bins.h"
#include "sim/speckle/scatterers/scatterer_cells.h"
#include "sim/speckle/scatterers/scatterer_projection.h"
#include "sim/speckle/scatterers/scatterer_settings.h"
#include "sim/speckle/scatterers/tissue_blocks.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

/// The beam of sticks at about one angle, or at its opposite.
struct StickBeam {
  std::vector<BeamAtRow> rows;
  BeamBounds bounds;
  std::vector<BlockReach> reaches;  ///< by the row of a block's centre
  const BandValues* lateral;        ///< of the table
};

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
  BeamProfile profile;
  FrequencyCourse course;  ///< which the table and the density follow
  double per_m3;           ///< density of the scatterers of all octaves
  double pulse_m;          ///< integral of the pulse's power over range: its equivalent length
  ScattererCells cells;
  TissueBlocks blocks;
  std::vector<OctaveGain> gains;
  /// [row][level of PulseTaps]: the factor on even tissue for which it echoes at a lower frequency,
  /// whose beam is wider, as at the one sent, but for what PulseBand cuts off below kLowest.
  std::vector<std::array<float, PulseTaps::kLevels>> tissue_gain;
  /// [angle][1: the angle is negative]
  std::vector<std::array<StickBeam, 2>> beams;
  BeamRim rim;
  PulseBand band;
  PulseTaps taps;
  std::vector<BandValues> places;  ///< EchoConstants::places

  const StickBeam& beam(const hw::Ray& stick) const;
  EchoConstants echo_constants(const StickBeam& beam, std::int32_t last_bin) const;
  /// For the scatterers of an octave; of no octave: for project_point().
  BeamProjection projection(const StickBeam& beam, const OctaveGain* octave = nullptr) const {
    return {beam.rows.data(),
            octave == nullptr ? nullptr : octave->rows.data(),
            table.columns(),
            table.rows() - 1,
            static_cast<float>(table.rows_per_m()),
            rim};
  }
  /// Rows of the beam's table about a block's centre that scatterers of the block may lie in.
  int window() const;
  BlockGrid block_grid() const {
    return {blocks.origin_m(), blocks.side_m(), blocks.first(), blocks.last()};
  }

 private:
  /// `per_cell`: least number of scatterers in each resolution cell.
  void compute_octave_gains(double per_cell);
  void compute_tissue_gain();
  /// The octaves at a row, where a density is needed.
  std::vector<OctaveAtRow> octaves_at(int row, double needed_per_m3) const;
  /// By row.
  std::vector<double> needed_per_m3(double per_cell) const;
  void add_beam(std::size_t angle, double depth_m);
  std::vector<BeamAtRow> rows_of(const BeamTable::Direction& lateral, bool mirrored) const;
};

}  // namespace wobblebench::sim
