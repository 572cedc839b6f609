// Report and document of the command `board`.
#pragma once

#include <string>
#include <vector>

#include "bench/output/report_parts.h"
#include "bench/studies/board_speed/board_speed.h"

namespace wobblebench::bench {

/// The text of report.json.
std::string board_speed_report(const Throughput& throughput,
                               const std::vector<CancelTimes>& cancels,
                               Provenance provenance);

/// Markdown: MB/s of each stage, and how soon a cancelled wait returns.
std::string board_speed_markdown(const Throughput& throughput,
                                 const std::vector<CancelTimes>& cancels,
                                 const Provenance& provenance);

}  // namespace wobblebench::bench
