// The program wobblebench-tables as a whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iterator>
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

/// A recording whose sticks are changed.
std::string recording_with(const std::function<void(hw::Stick&)>& change) {
  const hw::AcquisitionPlan plan = testing::recorded_plan();
  hw::Bytes bytes;
  encode(hw::configuration_of(plan, 0), bytes);
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(plan.sticks_per_volume()); ++i) {
    hw::Stick stick = hw::test_stick(plan, i);
    change(stick);
    encode(stick, bytes);
  }
  encode(hw::volume_end_of(plan, 0), bytes);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST(TablesProgram, SaysByHowMuchMotorAnglesLeaveThePlan) {
  const ScratchFolder folder;
  folder.write("a.wbst",
               recording_with([](hw::Stick& stick) { stick.motor_angle_rad += 2 * kDegree; }));
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

constexpr const char* kOneSize[] = {"--divisor", "8", "--repeats", "1"};

Words of_small_size(Words arguments) {
  arguments.insert(arguments.end(), std::begin(kOneSize), std::end(kOneSize));
  return arguments;
}

TEST(TablesProgram, ComparesItsPictureWithAnotherContexts) {
  const ScratchFolder folder;
  // Tissue from the middle of each stick on.
  folder.write("a.wbst", recording_with([](hw::Stick& stick) {
                 const auto middle = stick.samples.begin() + std::ssize(stick.samples) / 2;
                 std::fill(stick.samples.begin(), middle, 0.1F);
                 std::fill(middle, stick.samples.end(), 0.8F);
               }));
  const Words of_a = {"--board", "file=a.wbst"};
  Words pictures = of_small_size(of_a);
  pictures.insert(pictures.end(), {"--pictures", "--out", "other"});
  ASSERT_EQ(tables(pictures, folder).exit_code, 0);
  Words against = of_small_size(of_a);
  against.insert(against.end(), {"--against", "other", "--json"});
  const ProcessResult result = tables(against, folder);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto report = nlohmann::json::parse(result.out);
  const auto& pictures_of = report.at("agreement").at("pictures");
  ASSERT_EQ(pictures_of.size(), 2U);
  for (const auto& picture : pictures_of) {
    EXPECT_GT(picture.at("pixels"), 1000);
    EXPECT_EQ(picture.at("unexplained_share"), 0);
    EXPECT_EQ(picture.at("light_largest"), 0);
  }
}

TEST(TablesProgram, RefusesPicturesOfAnotherVolumeOrSize) {
  const ScratchFolder folder;
  folder.write("a.wbst", testing::recording_of(testing::recorded_plan()));
  folder.write("b.wbst", testing::recording_of(testing::recorded_plan(41)));
  Words pictures = of_small_size({"--board", "file=a.wbst", "--pictures", "--out", "other"});
  ASSERT_EQ(tables(pictures, folder).exit_code, 0);
  const auto expect_refused = [&](const Words& arguments, const std::string& why) {
    const ProcessResult result = tables(arguments, folder);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_NE(result.err.find(why), std::string::npos) << result.err;
  };
  expect_refused(of_small_size({"--board", "file=b.wbst", "--against", "other"}),
                 "--against = other: shows another volume than --board file=b.wbst");
  expect_refused({"--board", "file=a.wbst", "--divisor", "4", "--against", "other"},
                 "--against = other: has pictures of 64 x 64 pixels; must be 128 x 128");
  expect_refused({"--board", "file=a.wbst", "--against", "a.wbst"},
                 "--against = a.wbst: must be the folder of a run with --pictures");
  folder.write("other/pictures.npy", "no array");
  expect_refused(of_small_size({"--board", "file=a.wbst", "--against", "other"}),
                 "--against = other: pictures.npy is no readable NumPy file");
}

TEST(TablesProgram, TheScriptForGpusRefusesACpu) {
  const ScratchFolder folder;
  const auto backends = render::context_backends();
  if (std::ranges::find(backends, "egl") == backends.end()) GTEST_SKIP() << "no EGL here";
  if (render::make_context("egl")->renderer_string().find("llvmpipe") == std::string::npos) {
    GTEST_SKIP() << "EGL is a GPU's here";
  }
  namespace fs = std::filesystem;
  fs::create_directories(folder.path() / "pack/scan");
  fs::create_directories(folder.path() / "pack/egl");
  fs::copy(WOBBLEBENCH_SOURCE_DIR "/script/gpu", folder.path() / "pack/gpu");
  fs::create_symlink(WOBBLEBENCH_TABLES_PROGRAM, folder.path() / "pack/wobblebench-tables");
  folder.write("pack/scan/recording.wbst", testing::recording_of(testing::recorded_plan()));
  const ProcessResult result =
      run_process("/bin/bash", of_small_size({"pack/gpu", "--gl", "egl"}), folder.path());
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.err.find("wobblebench-tables: --gpu: --gl egl renders on the CPU: llvmpipe"), 0u)
      << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_FALSE(fs::exists(folder.path() / "out"));
}

}  // namespace
}  // namespace wobblebench::bench
