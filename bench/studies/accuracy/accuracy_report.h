// Measures over scenes, rungs, settings and seeds, as accuracy.csv, accuracy.md, report.json and
// pictures.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "bench/output/report_parts.h"
#include "bench/studies/accuracy/accuracy_study.h"

namespace wobblebench::bench {

/// One row a scene, rung, setting, seed and region; empty: not formed.
std::string accuracy_csv(const AccuracyResults& results);

/// Means with 95 % intervals, and differences to the first setting.
std::string accuracy_markdown(const AccuracyResults& results, const Provenance& provenance);

/// "accuracy": the summaries, the notes, and where the time went.
nlohmann::ordered_json accuracy_json(const AccuracyResults& results);

/// File of a picture.
std::string accuracy_picture_file(const AccuracyPicture& picture);

/// All pictures in one, for the display: a row for each scene and rung, a column for each setting
/// and for the truth.
Image<glm::vec3> accuracy_sheet(const AccuracyResults& results);
inline constexpr const char* kAccuracySheet = "accuracy_pictures.png";

}  // namespace wobblebench::bench
