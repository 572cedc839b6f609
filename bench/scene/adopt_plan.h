// Replaces probe and acquisition of a scene by those of a recording or a card.
#pragma once

#include <string>

#include "bench/scene/scene.h"

namespace wobblebench::bench {

/// Sets the scene's probe and acquisition to the plan's. Throws UserError "SECTION.KEY = VALUE:
/// SOURCE delivers OTHER" for a key that the user set to another value, and where the machine has
/// too little memory.
void adopt_plan(Scene& scene, const hw::AcquisitionPlan& plan, const std::string& source);

}  // namespace wobblebench::bench
