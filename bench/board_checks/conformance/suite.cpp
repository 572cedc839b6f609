#include "bench/board_checks/conformance/suite.h"

#include <algorithm>
#include <iterator>

#include "hw/link/link.h"

namespace wobblebench::bench {

const char* to_string(CheckOutcome::Kind kind) {
  switch (kind) {
    case CheckOutcome::Kind::passed:
      return "passed";
    case CheckOutcome::Kind::failed:
      return "failed";
    case CheckOutcome::Kind::skipped:
      return "skipped";
  }
  return "unknown";
}

std::vector<ConformanceCheck> conformance_checks() {
  std::vector<ConformanceCheck> all;
  for (auto part : {state_checks(),
                    slot_checks(),
                    account_checks(),
                    stream_checks(),
                    wait_checks(),
                    link_checks()}) {
    std::move(part.begin(), part.end(), std::back_inserter(all));
  }
  return all;
}

CheckOutcome run_check(const ConformanceCheck& check, const ConformanceFixture& fixture) {
  CheckOutcome outcome{check.name, check.rule, CheckOutcome::Kind::passed, ""};
  try {
    outcome.detail = check.run(fixture);
  } catch (const CheckSkipped& skipped) {
    outcome.kind = CheckOutcome::Kind::skipped;
    outcome.detail = skipped.what();
  } catch (const std::exception& error) {
    outcome.kind = CheckOutcome::Kind::failed;
    outcome.detail = error.what();
  }
  return outcome;
}

std::vector<CheckOutcome> run_conformance(const ConformanceFixture& fixture, const PartDone& done) {
  std::vector<CheckOutcome> outcomes;
  const auto checks = conformance_checks();
  PartCount parts(checks.size(), done);
  for (const auto& check : checks) {
    outcomes.push_back(run_check(check, fixture));
    parts.finish_one();
  }
  return outcomes;
}

int count(const std::vector<CheckOutcome>& outcomes, CheckOutcome::Kind kind) {
  return static_cast<int>(std::count_if(
      outcomes.begin(), outcomes.end(), [&](const auto& outcome) { return outcome.kind == kind; }));
}

}  // namespace wobblebench::bench
