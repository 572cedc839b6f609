// What `fit` reports: a document, report.json, pictures.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/output/document/document.h"
#include "bench/output/report_parts.h"
#include "bench/studies/fit/model_study.h"
#include "bench/studies/fit/planted_errors.h"

namespace wobblebench::bench {

struct FitResults {
  Registration known_pose;     ///< of the scene's picture, with the phantom's pose held
  Registration nothing_known;  ///< pose and probe at once
  std::optional<Coverage> coverage;
  ModelStudy model;
};

/// Sets "fit" of report.json.
nlohmann::ordered_json fit_json(const FitResults& results);

/// What people read, with fit_terms.csv, fit_held_out.csv, fit_residuals.csv, fit_coverage.csv.
Document fit_document(const FitResults& results, const Provenance& provenance);

/// A fitted value with its 95 % interval, in units that a person reads: "rotation x 0.1 deg (0 to
/// 0.2)".
std::string fitted_text(const Registration& fit, int parameter);

/// Mean residuals against incidence, range and contrast.
std::vector<Figure> fit_figures(const ModelStudy& study);

/// Maps of error, modelled bias and what is left of a held-out scan: file, caption, and the
/// greatest size that its colours tell apart.
std::string residuals_file(const ResidualPicture& picture);
std::string residuals_caption(const ResidualPicture& picture);
double residuals_limit_mm(const ResidualPicture& picture);
Image<glm::vec3> residuals_picture(const ResidualPicture& picture);

}  // namespace wobblebench::bench
