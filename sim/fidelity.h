// Choice of the rung for a scene, and the list of effects that it models.
#pragma once

#include <string>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::sim {

struct Effect {
  std::string name;
  std::string left_out;  ///< the reason why it did not run; empty: it ran
};

struct Fidelity {
  Rung rung = Rung::field;  ///< never `automatic`
  std::string reason;
  std::vector<Effect> effects;  ///< in the order of the signal path
};

/// "auto", "geometry", "field", "scatterers" or "reference".
std::string to_string(Rung rung);

/// The rung that the options name, or else the lowest that models all effects that they switch on.
/// `moving`: tissue moves during the acquisition. `points`: the phantom has point scatterers.
/// Throws InvalidOption if the named rung does not model an effect that is switched on.
Fidelity choose_fidelity(const SimulationOptions& options,
                         const hw::AcquisitionPlan& plan,
                         bool moving,
                         bool points = false);

}  // namespace wobblebench::sim
