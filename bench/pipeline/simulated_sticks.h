// The sticks of a scene's simulated probe.
#pragma once

#include "bench/cache/phantom_cache.h"
#include "bench/pipeline/board_link.h"
#include "bench/scene/scene.h"

namespace wobblebench::bench {

/// Makes phantom and simulator once; each call of the result gives a source that begins with volume
/// 0. Throws UserError, InvalidOption.
MakeSticks simulated_sticks(Scene scene, PhantomCache cache = {});

}  // namespace wobblebench::bench
