#include "bench/checks/conformance/broken.h"

#include <algorithm>
#include <iterator>

#include "bench/pipeline/board_link.h"
#include "bench/pipeline/synthetic_sticks.h"

namespace wobblebench::bench {

ConformanceFixture sound_fixture(const std::string& board) {
  hw::AcquisitionOptions acquisition;
  acquisition.frames_per_volume = 5;
  acquisition.sticks_per_frame = 40;
  acquisition.samples_per_stick = 32;
  acquisition.volumes = 50;
  const hw::AcquisitionPlan plan({}, acquisition);
  ConformanceFixture fixture;
  fixture.open = [arguments = parse_board("sim" + board), plan] {
    return open_board_link(arguments, [&] { return synthetic_sticks(plan, 1); });
  };
  fixture.repeatable = true;
  fixture.faulty = board.find("faults=") != std::string::npos;
  return fixture;
}

std::vector<Breakage> breakages() {
  auto all = broken_boards();
  auto links = broken_links();
  std::move(links.begin(), links.end(), std::back_inserter(all));
  return all;
}

std::vector<BreakageOutcome> run_breakages() {
  const auto checks = conformance_checks();
  std::vector<BreakageOutcome> outcomes;
  for (Breakage& breakage : breakages()) {
    const auto meant = std::find_if(checks.begin(), checks.end(), [&](const auto& check) {
      return check.name == breakage.check;
    });
    if (meant == checks.end()) throw std::logic_error("no check is named " + breakage.check);
    CheckOutcome outcome = run_check(*meant, breakage.fixture);
    outcomes.push_back({std::move(breakage), std::move(outcome)});
  }
  return outcomes;
}

}  // namespace wobblebench::bench
