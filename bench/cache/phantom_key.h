// What a phantom and its tissue map depend on, as the keys of a cache.
#pragma once

#include <string>

#include "phantoms/options.h"

namespace wobblebench::bench {

/// Names every option with its exact value, the content of an imported file and of a list of
/// scatterers, the sources of this build, its compiler, and the versions of the libraries that
/// compute. Empty where the file cannot be read.
std::string phantom_key(const phantoms::PhantomOptions& options);

/// Of the map of a phantom with this key.
std::string tissue_map_key(const std::string& phantom, double reach_m);

}  // namespace wobblebench::bench
