// Cases at the ends of what is allowed, as extremes.md, extremes.csv and report.json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/output/provenance.h"
#include "bench/studies/extremes/extremes.h"

namespace wobblebench::bench {

struct ExtremesResults {
  std::vector<ExtremeOutcome> cases;
  std::vector<NumberOutcome> numbers;

  [[nodiscard]] int failed() const;
};

std::string extremes_markdown(const ExtremesResults& results, const Provenance& provenance);
/// One row a case, preset and pass; a refusal has one row without a pass.
std::string extremes_csv(const ExtremesResults& results);
/// "extremes".
nlohmann::ordered_json extremes_json(const ExtremesResults& results);

/// "rendered", "refused" or "FAILED: why".
std::string verdict(const ExtremeOutcome& outcome);

}  // namespace wobblebench::bench
