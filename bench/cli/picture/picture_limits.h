// The figures of one picture that --limit takes.
#pragma once

#include <optional>
#include <string>

#include "bench/evaluation/measures/picture_measures.h"

namespace wobblebench::bench {

/// picture_measures() over the whole picture, and the time of the picture unless it is none.
/// `measures`: null: there are none. `why_none`: why no measure is formed; empty: those are that
/// have a value.
Measurements picture_figures(const PictureMeasures* measures,
                             std::optional<double> frame_ms,
                             const std::string& why_none = "");

}  // namespace wobblebench::bench
