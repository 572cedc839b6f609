// Results of the conformance suite on several boards.
#pragma once

#include <string>
#include <vector>

#include "bench/board_checks/conformance/defects.h"
#include "bench/board_checks/conformance/suite.h"

namespace wobblebench::bench {

/// The suite on one board.
struct SuiteRun {
  std::string board;
  std::string faults;  ///< added around it; empty: none
  std::vector<CheckOutcome> outcomes;
};

struct ConformanceFindings {
  std::vector<SuiteRun> runs;
  std::vector<DefectOutcome> defects;

  /// No check failed, and every seeded defect was detected.
  bool passed() const;
};

}  // namespace wobblebench::bench
