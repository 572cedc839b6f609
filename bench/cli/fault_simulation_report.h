// Report and summary of the command `rehearse`.
#pragma once

#include <string>

#include "bench/board_checks/fault_simulation/fault_simulation.h"

namespace wobblebench::bench {

/// The text of report.json.
std::string fault_simulation_report(const SeedRangeResult& all);

/// A few lines for a terminal; for each failure the command that repeats it.
std::string fault_simulation_summary(const SeedRangeResult& all);

}  // namespace wobblebench::bench
