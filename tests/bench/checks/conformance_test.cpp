// The suite passes on what is sound, and each of its checks fails on what is broken.
#include <gtest/gtest.h>

#include <set>

#include "bench/checks/conformance/board_fixture.h"
#include "bench/checks/conformance/broken.h"
#include "bench/checks/conformance/suite.h"

namespace wobblebench::bench {
namespace {

void expect_conforming(const ConformanceFixture& fixture) {
  for (const CheckOutcome& outcome : run_conformance(fixture)) {
    EXPECT_NE(outcome.kind, CheckOutcome::Kind::failed) << outcome.name << ": " << outcome.detail;
  }
}

TEST(Conformance, ASoundBoardPassesAndSkipsOnlyWhatItCannotShow) {
  for (const CheckOutcome& outcome : run_conformance(sound_fixture())) {
    EXPECT_NE(outcome.kind, CheckOutcome::Kind::failed) << outcome.name << ": " << outcome.detail;
    EXPECT_EQ(outcome.kind == CheckOutcome::Kind::skipped, outcome.name == "unplug.card")
        << outcome.name << ": " << outcome.detail;
  }
}

TEST(Conformance, ACardAtItsOwnPacePasses) {
  expect_conforming(sound_fixture(",pace=realtime"));
}

TEST(Conformance, EachFaultIsNoBreach) {
  for (const std::string& faults : each_fault()) {
    SCOPED_TRACE(faults);
    expect_conforming(with_faults(sound_fixture(), faults));
    expect_conforming(with_faults(sound_fixture(",pace=realtime"), faults));
  }
}

TEST(Conformance, EveryBreakageIsCaughtByTheCheckMeantForIt) {
  for (const BreakageOutcome& breakage : run_breakages()) {
    EXPECT_TRUE(breakage.caught())
        << breakage.breakage.check << " does not see: " << breakage.breakage.what << " ("
        << breakage.outcome.detail << ")";
  }
}

TEST(Conformance, ThereIsABreakageForEveryCheck) {
  std::set<std::string> broken;
  for (const Breakage& breakage : breakages()) broken.insert(breakage.check);
  for (const ConformanceCheck& check : conformance_checks()) {
    EXPECT_TRUE(broken.contains(check.name)) << check.name;
    EXPECT_FALSE(check.rule.empty());
  }
}

}  // namespace
}  // namespace wobblebench::bench
