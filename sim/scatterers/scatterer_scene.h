// What all sticks share when they look for scatterers.
#pragma once

#include <limits>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/beam/beam_bounds.h"
#include "sim/options.h"
#include "sim/scatterers/cell_search.h"
#include "sim/scatterers/range_bins.h"
#include "sim/scatterers/scatterer_cells.h"
#include "sim/scatterers/scatterer_projection.h"
#include "sim/tissue/scanned_tissue.h"
#include "sim/tissue/tissue_parcels.h"

namespace wobblebench::sim {

/// How scatterers are seen. The defaults are what the rung `scatterers` does.
struct ScattererModel {
  BeamShape beam = BeamShape::main_lobe;
  bool all_octaves = false;  ///< full density at every range (sim/scatterers/scatterer_cells.h)

  static ScattererModel of(const SimulationOptions& options) {
    return {options.side_lobes ? BeamShape::side_lobes : BeamShape::main_lobe, false};
  }
};

/// Immutable after construction.
struct ScattererScene {
  ScattererScene(const ScannedTissue& subject,
                 const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options,
                 const ScattererModel& model);

  /// One octave over the rows, and whether any scatterer of a parcel with its middle there is
  /// heard.
  struct OctaveGain {
    std::vector<OctaveAtRow> rows;
    std::vector<char> heard;
    /// Ranges between which it is not silent.
    float begin_m = std::numeric_limits<float>::infinity();
    float end_m = 0;
  };

  ScannedTissue subject;
  BeamTable table;
  double per_m3;   ///< scatterers, all octaves
  double pulse_m;  ///< length of a pulse of even power that has the same energy
  ScattererCells cells;
  TissueParcels parcels;
  std::vector<OctaveGain> gains;
  std::vector<BeamAtRow> rows;
  BeamBounds tube;
  std::vector<ParcelReach> reaches;  ///< by the row of a parcel's middle
  BeamRim rim;
  PulseTaps taps;
  double cycles_per_m;  ///< of range, there and back

  /// `octave`: as it is heard; none for given places.
  Sight sight(const OctaveGain* octave) const {
    return {rows.data(),
            octave == nullptr ? nullptr : octave->rows.data(),
            table.columns(),
            table.rows() - 1,
            static_cast<float>(table.rows_per_m()),
            rim};
  }
  ParcelGrid lattice() const {
    return {parcels.origin_m(), parcels.side_m(), parcels.first(), parcels.last()};
  }

 private:
  /// `per_cell`: scatterers that each resolution cell needs, at least.
  void weigh_octaves(const hw::AcquisitionPlan& plan, double per_cell);
  void tabulate_rows();
};

}  // namespace wobblebench::sim
