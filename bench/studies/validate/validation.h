// All studies of the simulator's physics, and what they report.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/output/document/document.h"
#include "bench/output/report_parts.h"
#include "bench/studies/validate/common/study_report.h"

namespace wobblebench::bench {

struct NamedStudy {
  std::string id;  ///< as --study takes it
  std::string title;
  double usual_s = 1;  ///< wall time on two cores, for the time that is left
  std::function<StudyReport()> run;
};

/// In the order of the Markdown document.
const std::vector<NamedStudy>& validation_studies();

/// Runs one and gives its report id and title. An exception becomes a failed check.
StudyReport run_study(const NamedStudy& study);

[[nodiscard]] int failed_checks(const std::vector<StudyReport>& reports);

/// "1.869; 1.913 +- 0.02 expected (…); n = …; seeds …"
std::string describe(const Check& check);

/// Checks and charts, with every point of every study as validation.csv.
Document validation_document(const std::vector<StudyReport>& reports, const Provenance& provenance);
/// "checks" of report.json.
nlohmann::ordered_json checks_json(const std::vector<StudyReport>& reports);

}  // namespace wobblebench::bench
