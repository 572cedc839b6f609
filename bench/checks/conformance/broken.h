// Deliberately broken boards and links: for each check of the suite one that it has to catch, which
// proves that the check can fail.
#pragma once

#include <string>
#include <vector>

#include "bench/checks/conformance/suite.h"

namespace wobblebench::bench {

struct Breakage {
  std::string check;  ///< the one that is meant to catch it
  std::string what;   ///< is wrong with it
  ConformanceFixture fixture;
};

/// Small synthetic streams, each broken in one way.
std::vector<Breakage> breakages();
std::vector<Breakage> broken_boards();
std::vector<Breakage> broken_links();

/// A sound board over synthetic sticks: what the broken ones are made of. `board` as --board takes
/// it after "sim", say ",pace=realtime,faults=drop:0.1".
ConformanceFixture sound_fixture(const std::string& board = "");

struct BreakageOutcome {
  Breakage breakage;
  CheckOutcome outcome;  ///< of the check that is meant
  bool caught() const { return outcome.kind == CheckOutcome::Kind::failed; }
};
std::vector<BreakageOutcome> run_breakages();

}  // namespace wobblebench::bench
