// The program wobblebench-tables as a whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/units.h"
#include "render/gl/context.h"
#include "tests/bench/studies/tables/recording.h"
#include "tests/support/process.h"

namespace wobblebench::bench {
namespace {

using testing_support::ProcessResult;
using testing_support::run_process;
using testing_support::ScratchFolder;
using Words = std::vector<std::string>;

ProcessResult tables(const Words& arguments, const ScratchFolder& folder) {
  return run_process(WOBBLEBENCH_TABLES_PROGRAM, arguments, folder.path());
}

struct BadInput {
  std::string name;
  Words arguments;
  std::string expected;  ///< what the one line holds
  int exit_code = 2;
};

void PrintTo(const BadInput& bad, std::ostream* out) {
  *out << bad.name;
}

class TablesProgramRefuses : public ::testing::TestWithParam<BadInput> {};

TEST_P(TablesProgramRefuses, WithOneLine) {
  const ScratchFolder folder;
  const std::string bytes = testing::recording_of(testing::recorded_plan());
  folder.write("whole.wbst", bytes);
  folder.write("cut.wbst", bytes.substr(0, bytes.size() / 2));
  folder.write("short.wbst", testing::recording_of(testing::recorded_plan(9)));
  folder.write("foreign.wbst", std::string(5000, 'x'));
  const ProcessResult result = tables(GetParam().arguments, folder);
  EXPECT_EQ(result.exit_code, GetParam().exit_code);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_EQ(result.err.find("wobblebench-tables: "), 0u) << result.err;
  EXPECT_NE(result.err.find(GetParam().expected), std::string::npos) << result.err;
  EXPECT_TRUE(folder.files("out").empty()) << "left something behind";
}

INSTANTIATE_TEST_SUITE_P(
    Tables,
    TablesProgramRefuses,
    ::testing::Values(
        BadInput{"no_board", {}, "--board is required"},
        BadInput{"simulated_board", {"--board", "sim"}, "--board = sim: must be file=RECORDING"},
        BadInput{"missing_file", {"--board", "file=none.wbst"}, "none.wbst"},
        BadInput{"foreign_file", {"--board", "file=foreign.wbst"}, "foreign.wbst"},
        BadInput{"cut_file", {"--board", "file=cut.wbst"}, "the stream is cut short"},
        BadInput{
            "few_frames", {"--board", "file=short.wbst"}, "9 frames a volume; the tables need"},
        BadInput{"unknown_gl",
                 {"--board", "file=whole.wbst", "--gl", "glide"},
                 "--gl: glide not in {auto,"},
        BadInput{"odd_divisor", {"--board", "file=whole.wbst", "--divisor", "3"}, "--divisor: "},
        BadInput{"unwritable_out",
                 {"--board", "file=whole.wbst", "--out", "/proc/out"},
                 "--out = /proc/out: "}),
    [](const auto& test) { return test.param.name; });

TEST(TablesProgram, WritesWhatItMeasuredOnARecording) {
  const ScratchFolder folder;
  folder.write("a.wbst", testing::recording_of(testing::recorded_plan()));
  const ProcessResult result =
      tables({"--board", "file=a.wbst", "--divisor", "8", "--repeats", "1", "--json"}, folder);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(folder.files("out"),
            (Words{"report.html",
                   "report.json",
                   "tables.csv",
                   "tables.md",
                   "tables_frames_size.vl.json",
                   "tables_kernels.vl.json"}));
  const auto report = nlohmann::json::parse(result.out);
  EXPECT_EQ(report.at("command"), "tables");
  EXPECT_EQ(report.at("provenance").at("board"), "recording");
  EXPECT_EQ(report.at("provenance").at("gl_backend"), render::make_context()->backend());
  EXPECT_EQ(report.at("acquisition").at("frames"), 37);
  EXPECT_EQ(report.at("timing").at("tables").size(), 4u);
}

TEST(TablesProgram, SaysByHowMuchMotorAnglesLeaveThePlan) {
  const ScratchFolder folder;
  const hw::AcquisitionPlan plan = testing::recorded_plan();
  hw::Bytes bytes;
  encode(hw::configuration_of(plan, 0), bytes);
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(plan.sticks_per_volume()); ++i) {
    hw::Stick stick = hw::test_stick(plan, i);
    stick.motor_angle_rad += 2 * kDegree;
    encode(stick, bytes);
  }
  encode(hw::volume_end_of(plan, 0), bytes);
  folder.write("a.wbst", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  const ProcessResult result =
      tables({"--board", "file=a.wbst", "--divisor", "8", "--repeats", "1", "--json"}, folder);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("motor angles leave the plan by at most 2 deg (RMS 2 deg)"),
            std::string::npos)
      << result.err;
  const auto motor = nlohmann::json::parse(result.out).at("acquisition").at("motor_angles");
  EXPECT_NEAR(motor.at("off_plan_max_deg"), 2, 1e-6);
}

TEST(TablesProgram, HelpIsNoError) {
  const ScratchFolder folder;
  EXPECT_EQ(tables({"--help"}, folder).exit_code, 0);
}

}  // namespace
}  // namespace wobblebench::bench
