// All studies of the simulator's physics, and the page that they make.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/report/provenance.h"
#include "bench/studies/validate/study.h"

namespace wobblebench::bench {

struct NamedStudy {
  std::string id;
  std::function<StudyReport()> run;  ///< at full size
};

/// In the order of the page.
const std::vector<NamedStudy>& validation_studies();

/// Runs one. What it throws becomes a check that failed.
StudyReport run_study(const NamedStudy& study);

int failed_checks(const std::vector<StudyReport>& reports);

/// "1.869; 1.913 +- 0.02 expected (…); n = …; seeds …"
std::string describe(const Check& check);

/// `figure_path`: what stands before a figure's file name in the page's links.
std::string validation_page(const std::vector<StudyReport>& reports,
                            const Provenance& provenance,
                            const std::string& figure_path);
/// Every point of every study.
std::string validation_csv(const std::vector<StudyReport>& reports);
nlohmann::ordered_json checks_json(const std::vector<StudyReport>& reports);

/// File of a figure.
std::string figure_file(const Figure& figure);

}  // namespace wobblebench::bench
