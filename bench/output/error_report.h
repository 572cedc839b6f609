// "error" of report.json: everything that is measured of a picture against the truth.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "bench/evaluation/measures/picture_measures.h"
#include "bench/scene/resolved_scene.h"

namespace wobblebench::bench {

/// In mode "volume" no surface is computed, so that none is missed.
bool computes_surface(const ResolvedScene& scene);

ExpectedSurface expected_surface(const ResolvedScene& scene);

/// Why the truth shows no surface in the picture; empty: it shows one.
std::string why_none(const DepthError& raw, const ExpectedSurface& expected);

/// Lengths in mm, angles in degrees. Figures that cannot be formed are null: where no surface was
/// sought (mode "volume"), and where there is none to be found.
nlohmann::ordered_json error_json(const PictureMeasures& measures, const ExpectedSurface& expected);

}  // namespace wobblebench::bench
