// The report of the command `latency`.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "bench/output/document/document.h"
#include "bench/output/report_parts.h"
#include "bench/studies/latency/latency_study.h"

namespace wobblebench::bench {

Document latency_document(const LatencyStudy& study,
                          const Provenance& provenance,
                          const Scene& scene);
/// "latency" of report.json: what the study was, and the document's tables.
nlohmann::ordered_json latency_study_json(const LatencyStudy& study, const Document& document);

}  // namespace wobblebench::bench
