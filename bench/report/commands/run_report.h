// Report, summary and images of the command `run`.
#pragma once

#include <filesystem>
#include <string>

#include "bench/pipeline/run_result.h"
#include "bench/report/output/output_folder.h"
#include "bench/report/report_parts.h"
#include "bench/scene/scene.h"

namespace wobblebench::bench {

/// The text of report.json.
std::string run_report(const RunResult& result, const Scene& scene, const StepTimes& times);

/// A few lines for a terminal. `directory`: where the results are.
std::string run_summary(const RunResult& result,
                        const Scene& scene,
                        const std::filesystem::path& directory);

/// Why the stream broke off, and how many sticks the volume lacks.
std::string ending_text(const RunResult& result);

/// How many sticks of how many the volume lacks.
std::string loss_text(const RunResult& result);

/// Stages the surface and volume images and the depth maps, found and true, in mm.
void stage_run_images(OutputFolder& out, const RunResult& result);

}  // namespace wobblebench::bench
