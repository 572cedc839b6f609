// What all sticks share when they look for scatterers.
#pragma once

#include <vector>

#include "hw/acquisition_plan.h"
#include "sim/beam_sections.h"
#include "sim/beam_tube.h"
#include "sim/echo_bins.h"
#include "sim/options.h"
#include "sim/scatterer_cells.h"
#include "sim/subject.h"
#include "sim/tissue_parcels.h"

namespace wobblebench::sim {

/// How scatterers are seen. The defaults are what the rung `scatterers` does.
struct ScattererModel {
  BeamShape beam = BeamShape::main_lobe;
  bool all_octaves = false;  ///< full density at every range (sim/scatterer_cells.h)

  static ScattererModel of(const SimulationOptions& options) {
    return {options.side_lobes ? BeamShape::side_lobes : BeamShape::main_lobe, false};
  }
};

/// Immutable after construction.
struct ScattererScene {
  ScattererScene(const Subject& subject,
                 const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options,
                 const ScattererModel& model);

  /// One octave over the rows: amplitude on the axis of each scatterer of a cell in tissue of echo
  /// power 1, and whether any scatterer of a parcel with its middle there has one.
  struct OctaveGain {
    std::vector<float> amplitude;  ///< [row][scatterer]
    std::vector<float> scaled;     ///< by the sections' scale
    std::vector<char> heard;
    int first_row = 0;  ///< rows between which it is not silent
    int last_row = -1;
  };

  Subject subject;
  BeamTable table;
  BeamSections sections;
  double per_m3;   ///< scatterers, all octaves
  double pulse_m;  ///< length of a pulse of even power that has the same energy
  ScattererCells cells;
  TissueParcels parcels;
  std::vector<OctaveGain> gains;
  std::vector<BeamAtRow> rows;
  BeamTube tube;
  BeamRim rim;
  PulseTaps taps;
  double cycles_per_m;  ///< of range, there and back

  /// `gain`: an octave's.
  Sight sight(const float* gain) const { return {rows.data(), table.columns(), rim, gain}; }
  ParcelLattice lattice() const { return {parcels.origin_m(), parcels.side_m()}; }

 private:
  void weigh_octaves(bool all);
  void tabulate_rows();
};

}  // namespace wobblebench::sim
