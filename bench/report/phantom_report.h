// Report and summary of the command `phantom`.
#pragma once

#include <string>

#include "bench/scene/scene.h"
#include "phantoms/phantom.h"

namespace wobblebench::bench {

/// The text of report.json.
std::string phantom_report(const phantoms::Phantom& phantom, const Scene& scene);

/// Surfaces with the sizes of their grids, materials, region of interest, joint; as JSON.
std::string phantom_summary(const phantoms::Phantom& phantom);

}  // namespace wobblebench::bench
