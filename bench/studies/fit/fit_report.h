// What `fit` writes: report.json, fit.md, CSV, pictures.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/evaluation/error_model/correction.h"
#include "bench/output/document/chart.h"
#include "bench/output/report_parts.h"
#include "bench/studies/fit/model_study.h"
#include "bench/studies/fit/planted_errors.h"

namespace wobblebench::bench {

struct FitResults {
  Registration known_pose;     ///< of the scene's picture, with the phantom's pose held
  Registration nothing_known;  ///< pose and probe at once
  std::optional<Coverage> coverage;
  ModelStudy model;
  Correction correction;
};

/// Sets "fit" of report.json.
nlohmann::ordered_json fit_json(const FitResults& results);
std::string fit_markdown(const FitResults& results, const Provenance& provenance);
/// One row for each term.
std::string terms_csv(const DetectionModel& model);
/// One row for each set of scans and rung.
std::string judgements_csv(const ModelStudy& study);
/// One row for each bin of held-out residuals.
std::string residuals_csv(const ModelStudy& study);
/// One row for each seed and parameter.
std::string coverage_csv(const Coverage& coverage);
/// Mean residuals against incidence, range and contrast; and maps of error, bias and residual.
std::vector<Figure> fit_figures(const ModelStudy& study);

struct NamedPicture {
  std::string file;
  std::string caption;
  Image<glm::vec3> picture;
};
/// Error, modelled bias and what is left of held-out scans.
std::vector<NamedPicture> residual_pictures(const ModelStudy& study);

}  // namespace wobblebench::bench
