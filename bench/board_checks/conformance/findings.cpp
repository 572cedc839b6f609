#include "bench/board_checks/conformance/findings.h"

#include <algorithm>

namespace wobblebench::bench {

bool ConformanceFindings::passed() const {
  return std::all_of(runs.begin(),
                     runs.end(),
                     [](const SuiteRun& run) {
                       return count(run.outcomes, CheckOutcome::Kind::failed) == 0;
                     }) &&
         std::all_of(defects.begin(), defects.end(), [](const DefectOutcome& defect) {
           return defect.detected();
         });
}

}  // namespace wobblebench::bench
