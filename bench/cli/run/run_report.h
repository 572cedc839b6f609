// What the command `run` has found: report, summary and images of it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/cache/phantom_cache.h"
#include "bench/cli/picture/picture_report.h"
#include "bench/output/report_parts.h"
#include "bench/pipeline/acquire.h"
#include "bench/scene/resolved_scene.h"
#include "bench/studies/tolerance/tolerance_report.h"
#include "hw/probe/motor_deviation.h"

namespace wobblebench::bench {

struct RunResult : PictureResult {
  RunResult(Acquisition acquired, render::Picture shown)
      : PictureResult{.picture = std::move(shown)}, acquisition(std::move(acquired)) {}

  Acquisition acquisition;
  std::string framed = {};        ///< --frame: the settings that it found
  std::string gl_backend = {};    ///< as --gl takes it
  std::string gl_renderer = {};   ///< GL_RENDERER and GL_VERSION
  PhantomCache::Kept kept = {};   ///< what was read from the cache
  hw::MotorDeviation motor = {};  ///< of the volume's sticks
  /// Passes of a second picture, whose texture fetches were counted; empty: not asked for.
  std::vector<render::PassTime> counted = {};
};

/// What the picture of a result reached of what was chosen for it.
ToleranceResult tolerance_result(const ToleranceChoice& choice, const RunResult& result);

/// The text of report.json. `tolerance`: none: not asked for.
std::string run_report(const RunResult& result,
                       const ResolvedScene& scene,
                       const StepTimes& times,
                       const std::optional<ToleranceResult>& tolerance = std::nullopt);

/// A few lines for a terminal. `directory`: where the results are.
std::string run_summary(const RunResult& result,
                        const ResolvedScene& scene,
                        const std::filesystem::path& directory,
                        const std::optional<ToleranceResult>& tolerance = std::nullopt);

/// Why the stream broke off, and how many sticks the volume lacks.
std::string ending_text(const RunResult& result);

}  // namespace wobblebench::bench
