// The tables that all sticks of a scene share to compute the echoes of scatterers.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "hw/probe/probe.h"
#include "sim/optics/beam_profile.h"
#include "sim/speckle/scatterers/block_search.h"
#include "sim/speckle/scatterers/hash_cells.h"
#include "sim/speckle/scatterers/range_bins.h"
#include "sim/speckle/scatterers/scatterer_cells.h"
#include "sim/speckle/scatterers/scatterer_field.h"
#include "sim/speckle/scatterers/scatterer_projection.h"
#include "sim/speckle/scatterers/tissue_blocks.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

/// The beam of the sticks that share a lateral table, on one side of the sector.
struct StickBeam {
  std::vector<BeamAtRow> rows;
  BeamBounds bounds;
  std::vector<BlockReach> reaches;  ///< by the row of a block's centre
  const BandValues* lateral;        ///< of the table
};

/// Smallest and largest resolution cell of a beam at any range.
struct ResolutionCells {
  double smallest_m3;
  double largest_m3 = 0;

  ResolutionCells(const BeamProfile& profile, double depth_m);
};

/// Immutable after construction.
struct ScattererScene {
  ScattererScene(const ScannedTissue& scanned,
                 const ProbeOptics& probe_optics,
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
  ProbeOptics optics;
  BeamTable table;
  FrequencyCourse course;  ///< determines the reach of the table and the density of scatterers
  ResolutionCells resolution;
  double per_m3;   ///< density of the scatterers of all octaves
  double pulse_m;  ///< integral of the pulse's power over range: its equivalent length
  ScattererCells cells;
  TissueBlocks blocks;
  std::vector<OctaveGain> gains;
  /// [angle][1: the angle is negative]
  std::vector<std::array<StickBeam, 2>> beams;
  BeamRim rim;
  PulseTaps taps;
  std::vector<BandValues> bin_phasors;  ///< EchoConstants::bin_phasors

  const StickBeam& beam(const hw::Ray& stick) const;
  EchoConstants echo_constants(const StickBeam& beam, std::int32_t last_bin) const;
  /// For the scatterers of an octave, or without one for project_point().
  BeamProjection projection(const StickBeam& beam, const OctaveGain* octave = nullptr) const {
    return {beam.rows.data(),
            octave == nullptr ? nullptr : octave->rows.data(),
            table.columns(),
            table.rows() - 1,
            static_cast<float>(table.rows_per_m()),
            rim};
  }
  /// Number of rows of the beam's table, on either side of the row of a block's centre, in which
  /// scatterers of the block may lie.
  int window() const;
  BlockGrid block_grid() const {
    return {blocks.origin_m(), blocks.side_m(), blocks.first(), blocks.last()};
  }

 private:
  /// `per_cell`: least number of scatterers in a resolution cell.
  void compute_octave_gains(double per_cell);
  /// Amplitudes of the octaves at a row, for the density that is needed there.
  std::vector<OctaveAtRow> octaves_at(int row, double needed_per_m3) const;
  /// Density of scatterers needed at each row.
  std::vector<double> needed_per_m3(double per_cell) const;
  void add_beam(std::size_t angle, double depth_m);
  std::vector<BeamAtRow> rows_of(const BeamTable::Direction& lateral, bool mirrored) const;
};

}  // namespace wobblebench::sim
