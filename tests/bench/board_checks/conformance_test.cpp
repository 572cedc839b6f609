// The suite passes on correct boards, and each of its checks detects the defect seeded for it.
#include <gtest/gtest.h>

#include <set>

#include "bench/board_checks/conformance/suite.h"
#include "bench/pipeline/board_link.h"
#include "bench/scene/scene.h"
#include "tests/bench/board_checks/defects.h"
#include "tests/support/expect.h"

namespace wobblebench::bench {
namespace {

void expect_conforming(const ConformanceFixture& fixture) {
  for (const CheckOutcome& outcome : run_conformance(fixture)) {
    EXPECT_NE(outcome.kind, CheckOutcome::Kind::failed) << outcome.name << ": " << outcome.detail;
  }
}

TEST(Conformance, ACorrectBoardPassesAndSkipsOnlyUnpluggingTheCard) {
  for (const CheckOutcome& outcome : run_conformance(correct_fixture())) {
    EXPECT_NE(outcome.kind, CheckOutcome::Kind::failed) << outcome.name << ": " << outcome.detail;
    EXPECT_EQ(outcome.kind == CheckOutcome::Kind::skipped, outcome.name == "unplug.card")
        << outcome.name << ": " << outcome.detail;
  }
}

TEST(Conformance, ACardAtItsOwnPacePasses) {
  expect_conforming(correct_fixture(",pace=realtime"));
}

/// The rung geometry has no noise: a sphere on the axis has equal echoes on both sides of it.
TEST(Conformance, SticksThatSymmetryMakesAlikeAreNotStale) {
  const Scene scene = load_scene({},
                                 {"phantom.name=sphere",
                                  "phantom.voxel_mm=2",
                                  "simulation.fidelity=geometry",
                                  "acquisition.frames_per_volume=9",
                                  "acquisition.sticks_per_frame=16"});
  const ConformanceFixture fixture = fixture_of(parse_board("sim"), scene);
  for (const CheckOutcome& outcome : run_conformance(fixture)) {
    if (outcome.name != "stream.stale") continue;
    EXPECT_EQ(outcome.kind, CheckOutcome::Kind::passed) << outcome.detail;
    EXPECT_TRUE(holds(outcome.detail, "alike by symmetry"));
  }
}

TEST(Conformance, InjectedFaultsAreNoFailure) {
  for (const std::string& faults : each_fault()) {
    SCOPED_TRACE(faults);
    expect_conforming(with_faults(correct_fixture(), faults));
    expect_conforming(with_faults(correct_fixture(",pace=realtime"), faults));
  }
}

TEST(Conformance, EveryDefectIsDetectedByItsCheck) {
  for (const DefectOutcome& defect : check_defects()) {
    EXPECT_TRUE(defect.detected())
        << defect.defect.check << " does not detect: " << defect.defect.what << " ("
        << defect.outcome.detail << ")";
  }
}

TEST(Conformance, ThereIsADefectForEveryCheck) {
  std::set<std::string> with_defect;
  for (const Defect& defect : seeded_defects()) with_defect.insert(defect.check);
  for (const ConformanceCheck& check : conformance_checks()) {
    EXPECT_TRUE(with_defect.contains(check.name)) << check.name;
    EXPECT_FALSE(check.rule.empty());
  }
}

}  // namespace
}  // namespace wobblebench::bench
