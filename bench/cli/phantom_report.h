// Report and summary of the command `phantom`.
#pragma once

#include <filesystem>
#include <string>

#include "bench/scene/scene.h"
#include "phantoms/phantom.h"

namespace wobblebench::bench {

/// The text of report.json.
std::string phantom_report(const phantoms::Phantom& phantom, const Scene& scene);

/// Surfaces with the sizes of their grids, region of interest, joint; `file`: where it was written.
std::string phantom_summary(const phantoms::Phantom& phantom, const std::filesystem::path& file);

}  // namespace wobblebench::bench
