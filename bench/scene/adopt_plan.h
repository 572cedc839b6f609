// Probe and acquisition of a scene, as a board outside the simulator has them.
#pragma once

#include <string>

#include "bench/scene/scene.h"

namespace wobblebench::bench {

/// Sets the scene's probe and acquisition to the plan's. Throws UserError "SECTION.KEY = VALUE:
/// SOURCE delivers OTHER" for a key that the scene was given otherwise, and where the machine has
/// too little memory for it.
void adopt_plan(Scene& scene, const hw::AcquisitionPlan& plan, const std::string& source);

}  // namespace wobblebench::bench
