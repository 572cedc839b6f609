// Report, document and summary of the command `conformance`.
#pragma once

#include <string>

#include "bench/board_checks/conformance/defects.h"
#include "bench/output/provenance.h"
#include "bench/output/report_parts.h"
#include "bench/scene/scene.h"

namespace wobblebench::bench {

/// The text of report.json.
std::string conformance_report(const ConformanceFindings& findings,
                               const Scene& scene,
                               const StepTimes& times);

/// Markdown: checks against boards, then faults against boards, then the seeded defects.
std::string conformance_markdown(const ConformanceFindings& findings, const Provenance& provenance);

/// A line a check, for a terminal.
std::string conformance_summary(const ConformanceFindings& findings);

}  // namespace wobblebench::bench
