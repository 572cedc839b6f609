// The tissue maps of one phantom, for all who ask for them in turn.
#pragma once

#include "sim/probe_simulator.h"

namespace wobblebench::bench {

/// Takes the map of a phantom and a reach from `maps`, or makes it, once, and keeps it as long as
/// the result and its copies live. Those are for one thread. Another phantom's map replaces all.
sim::TissueMapSource kept_maps(sim::TissueMapSource maps);

}  // namespace wobblebench::bench
