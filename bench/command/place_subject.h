// What a command's samples are of.
#pragma once

#include <optional>

#include "bench/cache/phantom_cache.h"
#include "bench/output/progress.h"
#include "bench/scene/scene.h"
#include "hw/wire/configuration.h"
#include "phantoms/placed_phantom.h"

namespace wobblebench::bench {

/// The scene's phantom, placed, where the samples are of it; none: nobody knows what they are of.
/// Sets placement and volume of interest, where they were not given. Step "phantom".
std::optional<phantoms::PlacedPhantom> place_subject(Scene& scene,
                                                     hw::StreamOrigin source,
                                                     PhantomCache& cache,
                                                     Progress& progress);

}  // namespace wobblebench::bench
