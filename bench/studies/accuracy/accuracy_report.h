// Measures over scenes, rungs, settings and seeds, as a document, report.json and pictures.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "bench/output/document/document.h"
#include "bench/output/report_parts.h"
#include "bench/studies/accuracy/accuracy_study.h"

namespace wobblebench::bench {

/// Means with 95 % intervals, differences to the first setting, charts, and accuracy.csv: one row
/// for each scene, rung, setting, seed and region. The pictures of accuracy_picture_file() and
/// kAccuracySheet belong to it.
Document accuracy_document(const AccuracyResults& results, const Provenance& provenance);

/// "accuracy": the summaries, the notes, and where the time went.
nlohmann::ordered_json accuracy_json(const AccuracyResults& results);

/// Name of the file of a picture.
std::string accuracy_picture_file(const AccuracyPicture& picture);

/// All pictures in one, for the display: a row for each scene and rung, a column for each setting
/// and for the truth.
Image<glm::vec3> accuracy_sheet(const AccuracyResults& results);
inline constexpr const char* kAccuracySheet = "accuracy_pictures.png";

}  // namespace wobblebench::bench
