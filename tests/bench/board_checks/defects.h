// Seeded defects of boards and links: for each check of the suite one that it has to detect, which
// proves that the check can fail.
#pragma once

#include <string>
#include <vector>

#include "bench/board_checks/conformance/suite.h"

namespace wobblebench::bench {

struct Defect {
  std::string check;  ///< that has to detect it
  std::string what;   ///< the defect
  ConformanceFixture fixture;
};

/// Boards over small synthetic streams, with one defect each.
std::vector<Defect> seeded_defects();
std::vector<Defect> board_defects();
std::vector<Defect> link_defects();

/// The correct board over synthetic sticks that defects are seeded into. `arguments`: of --board,
/// after "sim", say ",pace=realtime,faults=drop:0.1".
ConformanceFixture correct_fixture(const std::string& arguments = "");

struct DefectOutcome {
  Defect defect;
  CheckOutcome outcome;  ///< of the check `defect.check`
  bool detected() const { return outcome.kind == CheckOutcome::Kind::failed; }
};
std::vector<DefectOutcome> check_defects();

}  // namespace wobblebench::bench
