// The conformance suite: the contract of hw::Board, checked on any link.
#pragma once

#include <string>
#include <vector>

#include "base/part_done.h"
#include "bench/board_checks/conformance/fixture.h"

namespace wobblebench::bench {

struct CheckOutcome {
  enum class Kind { passed, failed, skipped };
  std::string name;
  std::string rule;
  Kind kind = Kind::passed;
  std::string detail;
};
const char* to_string(CheckOutcome::Kind kind);

std::vector<ConformanceCheck> state_checks();
std::vector<ConformanceCheck> slot_checks();
std::vector<ConformanceCheck> account_checks();
std::vector<ConformanceCheck> stream_checks();
std::vector<ConformanceCheck> wait_checks();
std::vector<ConformanceCheck> link_checks();
/// All of them, in the order of the contract.
std::vector<ConformanceCheck> conformance_checks();

CheckOutcome run_check(const ConformanceCheck& check, const ConformanceFixture& fixture);
std::vector<CheckOutcome> run_conformance(const ConformanceFixture& fixture,
                                          const PartDone& done = {});

int count(const std::vector<CheckOutcome>& outcomes, CheckOutcome::Kind kind);

}  // namespace wobblebench::bench
