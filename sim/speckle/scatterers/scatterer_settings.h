// Choices within the scatterer rungs.
#pragma once

#include <utility>

#include "sim/optics/beam_table.h"
#include "sim/options.h"

namespace wobblebench::sim {

/// The defaults are those of the rung `scatterers` where nothing absorbs.
struct ScattererSettings {
  BeamShape beam = BeamShape::main_lobe;
  bool all_octaves =
      false;  ///< full density at every range (sim/speckle/scatterers/scatterer_cells.h)

  FrequencyCourse course = {};  ///< of the pulses that have fallen least: where they are lower
                                ///< the beam is wider, and its scatterers as much sparser

  static ScattererSettings of(const SimulationOptions& options, FrequencyCourse course = {}) {
    return {options.side_lobes ? BeamShape::side_lobes : BeamShape::main_lobe,
            false,
            std::move(course)};
  }
};

}  // namespace wobblebench::sim
