// What report.html of the command `run` shows.
#pragma once

#include <optional>
#include <string>

#include "bench/cli/run/run_report.h"
#include "bench/output/document/document.h"
#include "bench/scene/resolved_scene.h"

namespace wobblebench::bench {

/// Pictures, maps, errors, times and the board's account of a result, whose images are staged.
/// `summary`: as run_summary() has it.
Document run_document(const RunResult& result,
                      const ResolvedScene& scene,
                      const std::string& summary);

/// The same of a surface that another program found: without a volume, times and a board.
Document score_document(const PictureResult& result,
                        const ResolvedScene& scene,
                        const std::string& summary);

/// Percentages of the pixels with an error, by its size: the signed error in bins of 0.1 mm, and of
/// its magnitude those below each length.
Figure error_figure(const Image<float>& error_m);

}  // namespace wobblebench::bench
