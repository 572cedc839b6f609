// What the simulated probe of a scene sends.
#pragma once

#include "bench/pipeline/board_link.h"
#include "bench/scene/scene.h"

namespace wobblebench::bench {

/// Builds phantom and simulator once; each call gives a source that begins with volume 0. Throws
/// UserError, InvalidOption.
MakeSticks simulated_sticks(Scene scene);

}  // namespace wobblebench::bench
