// The program wobblebench-tables as a whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iterator>

#include "base/units.h"
#include "render/gl/context.h"
#include "tests/bench/cli/program_under_test.h"
#include "tests/bench/studies/tables/recording.h"

namespace wobblebench::bench {
namespace {

using TablesProgram = InFolder;

TEST_F(TablesProgram, RefusesBadInputWithOneLine) {
  const std::string bytes = testing::recording_of(testing::recorded_plan());
  folder_.write("whole.wbst", bytes);
  folder_.write("cut.wbst", bytes.substr(0, bytes.size() / 2));
  folder_.write("short.wbst", testing::recording_of(testing::recorded_plan(9)));
  folder_.write("foreign.wbst", std::string(5000, 'x'));
  expect_refusals({{"", "--board is required"},
                   {"--board sim", "--board = sim: must be file=RECORDING"},
                   {"--board file=none.wbst", "none.wbst"},
                   {"--board file=foreign.wbst", "foreign.wbst"},
                   {"--board file=cut.wbst", "the stream is cut short"},
                   {"--board file=short.wbst", "9 frames a volume; the tables need"},
                   {"--board file=whole.wbst --gl glide", "--gl: glide not in {auto,"},
                   {"--board file=whole.wbst --divisor 3", "--divisor: "},
                   {"--board file=whole.wbst --out /proc/out", "--out = /proc/out: "}});
}

TEST_F(TablesProgram, WritesWhatItMeasuredOnARecording) {
  folder_.write("a.wbst", testing::recording_of(testing::recorded_plan()));
  const ProcessResult result = bench("--board file=a.wbst --divisor 8 --repeats 1 --json");
  const auto report = report_of(result);
  EXPECT_EQ(folder_.files("out"),
            words_of("report.html report.json tables.csv tables.md tables_frames_size.vl.json "
                     "tables_kernels.vl.json"));
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

TEST_F(TablesProgram, SaysByHowMuchMotorAnglesLeaveThePlan) {
  folder_.write("a.wbst",
                recording_with([](hw::Stick& stick) { stick.motor_angle_rad += 2 * kDegree; }));
  const ProcessResult result = bench("--board file=a.wbst --divisor 8 --repeats 1 --json");
  EXPECT_TRUE(holds(result.err, "motor angles leave the plan by at most 2 deg (RMS 2 deg)"));
  const auto motor = report_of(result).at("acquisition").at("motor_angles");
  EXPECT_NEAR(motor.at("off_plan_max_deg"), 2, 1e-6);
}

TEST_F(TablesProgram, HelpIsNoError) {
  EXPECT_EQ(bench("--help").exit_code, 0);
}

const std::string kOneSize = " --divisor 8 --repeats 1";

TEST_F(TablesProgram, ComparesItsPictureWithAnotherContexts) {
  // Tissue from the middle of each stick on.
  folder_.write("a.wbst", recording_with([](hw::Stick& stick) {
                  const auto middle = stick.samples.begin() + std::ssize(stick.samples) / 2;
                  std::fill(stick.samples.begin(), middle, 0.1F);
                  std::fill(middle, stick.samples.end(), 0.8F);
                }));
  ASSERT_EQ(bench("--board file=a.wbst --pictures --out other" + kOneSize).exit_code, 0);
  const auto report = report_of(bench("--board file=a.wbst --against other --json" + kOneSize));
  const std::string renderer = report.at("provenance").at("gl_renderer");
  EXPECT_TRUE(report.at("against").get<std::string>().starts_with(renderer + ", commit "));
  const auto& pictures_of = report.at("agreement");
  ASSERT_EQ(pictures_of.size(), 2U);
  for (const auto& picture : pictures_of) {
    EXPECT_GT(picture.at("pixels"), 1000);
    EXPECT_EQ(picture.at("unexplained_percent"), 0);
    EXPECT_EQ(picture.at("light_largest"), 0);
  }
}

TEST_F(TablesProgram, RefusesPicturesOfAnotherVolumeOrSize) {
  folder_.write("a.wbst", testing::recording_of(testing::recorded_plan()));
  folder_.write("b.wbst", testing::recording_of(testing::recorded_plan(41)));
  ASSERT_EQ(bench("--board file=a.wbst --pictures --out other" + kOneSize).exit_code, 0);
  expect_line(bench("--board file=b.wbst --against other" + kOneSize),
              2,
              "--against = other: shows another volume than --board file=b.wbst");
  expect_line(bench("--board file=a.wbst --divisor 4 --against other"),
              2,
              "--against = other: has pictures of 64 x 64 pixels; must be 128 x 128");
  expect_line(bench("--board file=a.wbst --against a.wbst"),
              2,
              "--against = a.wbst: must be the folder of a run with --pictures");
  folder_.write("other/pictures.npy", "no array");
  expect_line(bench("--board file=a.wbst --against other" + kOneSize),
              2,
              "--against = other: pictures.npy is no readable NumPy file");
}

TEST_F(TablesProgram, TheScriptForGpusRefusesACpu) {
  const auto backends = render::context_backends();
  if (std::ranges::find(backends, "egl") == backends.end()) GTEST_SKIP() << "no EGL here";
  if (render::make_context("egl")->renderer_string().find("llvmpipe") == std::string::npos) {
    GTEST_SKIP() << "EGL is a GPU's here";
  }
  fs::create_directories(at("pack/scan"));
  fs::create_directories(at("pack/egl"));
  fs::copy(WOBBLEBENCH_SOURCE_DIR "/script/gpu", at("pack/gpu"));
  fs::create_symlink(WOBBLEBENCH_PROGRAM, at("pack/wobblebench-tables"));
  folder_.write("pack/scan/recording.wbst", testing::recording_of(testing::recorded_plan()));
  const ProcessResult result =
      run_process("/bin/bash", words_of("pack/gpu --gl egl" + kOneSize), folder_.path());
  expect_line(result, 1, "wobblebench-tables: --gpu: --gl egl renders on the CPU: llvmpipe");
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_FALSE(fs::exists(at("out")));
}

}  // namespace
}  // namespace wobblebench::bench
