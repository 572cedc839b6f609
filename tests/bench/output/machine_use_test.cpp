// What the kernel says of a machine, and when its times are called those of a busy one.
#include "bench/output/machine_use.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/output/finished_report.h"
#include "tests/support/expect.h"

namespace wobblebench::bench {
namespace {

/// A sample of a machine of 4 cores at that time, with these sums of CPU time.
MachineSample sample_at(double time_s, double busy_s, double stolen_s, double own_s) {
  MachineSample sample;
  sample.time_s = time_s;
  sample.busy_s = busy_s;
  sample.stolen_s = stolen_s;
  sample.own_s = own_s;
  sample.cores = 4;
  return sample;
}

TEST(MachineUse, CpuTimesAreThoseOfProcStat) {
  MachineSample sample;
  read_cpu_times("cpu  1000 200 300 99999 88888 40 60 70 500 5\ncpu0 1 2 3 4\n", 100, sample);
  EXPECT_DOUBLE_EQ(sample.busy_s, 16);  // user holds guest time
  EXPECT_DOUBLE_EQ(sample.stolen_s, 0.7);
  for (const char* stat : {"", "cpu  1 2", "intr 1 2 3 4 5 6 7 8"}) {
    read_cpu_times(stat, 100, sample);
    EXPECT_TRUE(std::isnan(sample.busy_s)) << stat;
  }
}

TEST(MachineUse, OthersHaveWhatThisProcessHasNot) {
  // 10 s of 4 cores, of which this process took 12 s, others 6 s and other guests 2 s.
  const MachineUse use{sample_at(100, 1000, 5, 1), sample_at(110, 1018, 7, 13)};
  EXPECT_DOUBLE_EQ(use.share_of_others(), 0.2);
  EXPECT_TRUE(holds(use.warning(), "20 % of the time of 4 cores"));
}

TEST(MachineUse, AnIdleMachineIsNotWarnedOf) {
  // This process may take all cores; what others take by the by is no reason to warn, nor is what
  // the counters of the kernel have rounded away.
  const auto warning = [](double busy_s, double own_s, double time_s) {
    return MachineUse{sample_at(0, 0, 0, 0), sample_at(time_s, busy_s, 0, own_s)}.warning();
  };
  EXPECT_EQ(warning(40, 40, 10), "");
  EXPECT_EQ(warning(43, 39, 10), "");
  EXPECT_EQ(warning(39, 40, 10), "");
  EXPECT_EQ(warning(1, 0.1, 0.1), "");
  EXPECT_EQ(warning(NAN, 1, 10), "");
  EXPECT_NE(warning(40, 20, 10), "");
}

/// Ticks that end within a short command: more than all of the time cannot have gone to others.
TEST(MachineUse, OthersHaveAllOfTheTimeAtMost) {
  MachineUse use;
  use.after.time_s = 0.01;
  use.after.busy_s = 0.03;
  EXPECT_EQ(use.share_of_others(), 1);
}

TEST(MachineUse, ThisMachineHasOne) {
  const MachineSample before = sample_machine();
  double sum = 0;
  for (int i = 0; i < 30000000; ++i) sum += std::sqrt(static_cast<double>(i));
  EXPECT_GT(sum, 0);
  const MachineUse use{before, sample_machine()};
  EXPECT_GT(use.after.own_s, use.before.own_s);
  EXPECT_GT(use.after.busy_s, 0);
  EXPECT_GE(use.after.load[0], 0);
  EXPECT_GE(use.after.cores, 1);
}

TEST(FinishedReport, WhatVariesKeepsItsPathBelowTiming) {
  nlohmann::ordered_json report = {{"command", "run"},
                                   {"simulation", nullptr},
                                   {"render", {{"mode", "fast"}, {"frame_ms", 2.5}}},
                                   {"wall_ms", {{"stream", 1}}}};
  move_to_timing(report);
  EXPECT_EQ(report.at("render"), (nlohmann::ordered_json{{"mode", "fast"}}));
  EXPECT_EQ(report.at("timing").at("render").at("frame_ms"), 2.5);
  EXPECT_EQ(report.at("timing").at("wall_ms").at("stream"), 1);
  EXPECT_FALSE(report.contains("wall_ms"));
}

TEST(FinishedReport, TimesHaveTheUseOfTheMachineBesideThem) {
  Progress progress;
  progress.warn("what was said");
  const auto finished = [&](const char* report) {
    return nlohmann::json::parse(finished_report(report, {}, progress));
  };
  const auto timed = finished(R"({"command": "fit", "provenance": {}, "wall_ms": {"fit": 1}})");
  EXPECT_EQ(timed.at("warnings"), nlohmann::json({"what was said"}));
  const auto& load = timed.at("provenance").at("load");
  EXPECT_EQ(load.at("before").at("load_average").size(), 3U);
  EXPECT_TRUE(load.contains("others_percent"));
  EXPECT_TRUE(load.contains("switched_away"));
  const auto untimed = finished(R"({"command": "phantom", "provenance": {}})");
  EXPECT_FALSE(untimed.at("provenance").contains("load"));
}

}  // namespace
}  // namespace wobblebench::bench
