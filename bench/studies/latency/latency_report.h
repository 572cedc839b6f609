// The report of the command `latency`.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "bench/output/document/document.h"
#include "bench/output/report_parts.h"
#include "bench/studies/latency/latency_study.h"

namespace wobblebench::bench {

/// "latency" of report.json.
nlohmann::ordered_json latency_study_json(const LatencyStudy& study);
Document latency_document(const LatencyStudy& study,
                          const Provenance& provenance,
                          const Scene& scene);

}  // namespace wobblebench::bench
