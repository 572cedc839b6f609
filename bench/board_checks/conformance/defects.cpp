#include "bench/board_checks/conformance/defects.h"

#include <algorithm>
#include <iterator>

#include "bench/pipeline/board_link.h"
#include "bench/pipeline/synthetic_sticks.h"

namespace wobblebench::bench {

ConformanceFixture correct_fixture(const std::string& arguments) {
  hw::AcquisitionOptions acquisition;
  acquisition.frames_per_volume = 5;
  acquisition.sticks_per_frame = 40;
  acquisition.samples_per_stick = 32;
  acquisition.volumes = 50;
  const hw::AcquisitionPlan plan({}, acquisition);
  ConformanceFixture fixture;
  fixture.open = [board = parse_board("sim" + arguments), plan] {
    return open_board_link(board, [&] { return synthetic_sticks(plan, 1); });
  };
  fixture.repeatable = true;
  fixture.faulty = arguments.find("faults=") != std::string::npos;
  return fixture;
}

std::vector<Defect> seeded_defects() {
  auto all = board_defects();
  auto links = link_defects();
  std::move(links.begin(), links.end(), std::back_inserter(all));
  return all;
}

std::vector<DefectOutcome> check_defects(const PartDone& done) {
  const auto checks = conformance_checks();
  std::vector<DefectOutcome> outcomes;
  auto defects = seeded_defects();
  PartCount parts(defects.size(), done);
  for (Defect& defect : defects) {
    const auto check = std::find_if(
        checks.begin(), checks.end(), [&](const auto& one) { return one.name == defect.check; });
    if (check == checks.end()) throw std::logic_error("no check is named " + defect.check);
    CheckOutcome outcome = run_check(*check, defect.fixture);
    outcomes.push_back({std::move(defect), std::move(outcome)});
    parts.finish_one();
  }
  return outcomes;
}

}  // namespace wobblebench::bench
