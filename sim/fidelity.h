// Which rung and which effects a scene asks for, and why.
#pragma once

#include <string>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::sim {

struct Effect {
  std::string name;
  std::string left_out;  ///< why it did not run; empty: it ran
};

struct Fidelity {
  Rung rung = Rung::field;  ///< never `automatic`
  std::string reason;
  std::vector<Effect> effects;  ///< in the order of the signal's way
};

/// "geometry", "field", "scatterers", "reference".
std::string to_string(Rung rung);

/// Takes the lowest rung that shows all effects that the options ask for; a rung that is asked for
/// by name is taken. `moving`: tissue moves during the acquisition. Throws InvalidOption where
/// the rung that is asked for cannot show an effect that is asked for.
Fidelity choose_fidelity(const SimulationOptions& options,
                         const hw::AcquisitionPlan& plan,
                         bool moving);

}  // namespace wobblebench::sim
