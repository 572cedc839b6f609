// The figures of one picture that --limit takes.
#pragma once

#include <string>
#include <vector>

#include "bench/command/limits.h"
#include "bench/evaluation/measures/picture_measures.h"

namespace wobblebench::bench {

/// Of picture_measures() those of which less is better.
const std::vector<std::string>& picture_measure_names();
/// Their values over the whole picture.
std::vector<LimitedFigure> picture_figures(const PictureMeasures& measures);

/// The same and frame_ms, the time of the picture.
const std::vector<std::string>& timed_picture_names();
/// `measures`: null: there are none. `why_none`: why no measure is formed; empty: those are that
/// have a value.
std::vector<LimitedFigure> timed_picture_figures(const PictureMeasures* measures,
                                                 double frame_ms,
                                                 const std::string& why_none);

}  // namespace wobblebench::bench
