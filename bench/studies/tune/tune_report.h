// What `tune` found, as a document, report.json and scene files.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/output/document/document.h"
#include "bench/results/check.h"
#include "bench/studies/tune/request_study.h"
#include "bench/studies/tune/tune_study.h"

namespace wobblebench::bench {

/// `machine`: what measured.
Document tune_document(const TuneResults& results, const std::string& machine);
nlohmann::ordered_json tune_json(const TuneResults& results);
/// Each limit, against the bound of the chosen point on the worst scene and fresh seeds, or against
/// the nearest point's; then on the worst of the plan's unseen scenes.
std::vector<Check> tune_checks(const TuneResults& results);
/// "point 3 (iso_level 0.5, steps 32): p95_mm 2.4 of at most 2 (20 % above), …"; empty: none is
/// known.
std::string nearest_text(const TuneResults& results);
/// tuned.toml; of a plan with several scenes tuned_NAME.toml.
std::string tuned_file(const TuneResults& results, std::size_t scene);
/// A scene of the plan with the chosen settings, as a scene file. `results.chosen()` must be one.
std::string tuned_scene(const TuneResults& results, std::size_t scene);

/// "least volume_ms with p95_mm <= 2 and missed_percent <= 5".
std::string request_text(const TuneRequest& request);

/// The greatest values that are allowed, by name.
nlohmann::ordered_json limits_json(const TuneRequest& request);

/// Many requests: document, and "requests" of report.json.
Document requests_document(const RequestStudy& study, const std::string& machine);
nlohmann::ordered_json requests_json(const RequestStudy& study);

}  // namespace wobblebench::bench
