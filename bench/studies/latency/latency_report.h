// The report of the command `latency`.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "bench/output/document/chart.h"
#include "bench/output/report_parts.h"
#include "bench/studies/latency/latency_study.h"

namespace wobblebench::bench {

inline constexpr const char* kCrossoverFigure = "latency_crossover.vl.json";

/// "latency" of report.json.
nlohmann::ordered_json latency_study_json(const LatencyStudy& study);
std::string latency_markdown(const LatencyStudy& study,
                             const Provenance& provenance,
                             const Scene& scene);
/// For which depth and number of frames sound takes longer than rendering; the scene is a point.
Figure crossover_figure(const LatencyStudy& study, const Scene& scene);

}  // namespace wobblebench::bench
