// Measures of a picture as JSON: "error" of report.json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "bench/evaluation/measures/picture_measures.h"

namespace wobblebench::bench {

/// Figures that cannot be formed are null: where no surface was sought (mode "volume"), and where
/// there is none to be found.
nlohmann::ordered_json error_json(const PictureMeasures& measures, bool surface_sought);

}  // namespace wobblebench::bench
