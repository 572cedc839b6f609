// Speed against accuracy of the simulator's rungs, as rungs.md, rungs.csv, report.json and figures.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/output/document/chart.h"
#include "bench/output/report_parts.h"
#include "bench/studies/rungs/rung_comparison.h"

namespace wobblebench::bench {

std::vector<Figure> rungs_figures(const RungsResults& results);

/// The middle frame of the phantom on each rung.
Image<glm::vec3> frames_picture(const RungsResults& results);

/// File of a figure.
std::string rungs_figure_file(const Figure& figure);

std::string rungs_markdown(const RungsResults& results, const Provenance& provenance);
std::string rungs_csv(const RungsResults& results);

/// "rungs": points with settings, time and error, and which of them lie on the Pareto front.
nlohmann::ordered_json rungs_json(const RungsResults& results);

}  // namespace wobblebench::bench
