// Measures over scenes, rungs, settings and seeds, as accuracy.csv, accuracy.md, report.json and
// pictures.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "bench/output/report_parts.h"
#include "bench/studies/accuracy/accuracy_study.h"

namespace wobblebench::bench {

/// One row for each scene, rung, setting, seed and region; empty cells: not formed.
std::string accuracy_csv(const AccuracyResults& results);

/// Means with 95 % intervals, and differences to the first setting.
std::string accuracy_markdown(const AccuracyResults& results, const Provenance& provenance);

/// "accuracy": the summaries, the notes, and where the time went.
nlohmann::ordered_json accuracy_json(const AccuracyResults& results);

/// Name of the file of a picture.
std::string accuracy_picture_file(const AccuracyPicture& picture);

/// All pictures in one, for the display: a row for each scene and rung, a column for each setting
/// and for the truth.
Image<glm::vec3> accuracy_sheet(const AccuracyResults& results);
inline constexpr const char* kAccuracySheet = "accuracy_pictures.png";

/// "1.25 ± 0.10", "1.25" of a single value, "" of none.
std::string interval_text(const MeanInterval& interval, int digits);
/// The same in brackets where the interval contains 0.
std::string difference_text(const MeanInterval& interval, int digits);

/// A number of a CSV row with 7 significant digits; empty unless it is finite.
std::string csv_number(double value);

}  // namespace wobblebench::bench
