// The command `accuracy`, by running the program.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

using Json = nlohmann::json;

const std::string kPlan =
    "seeds = 2\nrungs = [\"field\"]\nreference = \"paper\"\n"
    "[scenes.ball]\nphantom = { name = \"sphere\", voxel_mm = 2 }\n"
    "acquisition = { frames_per_volume = 9, sticks_per_frame = 16 }\n"
    "[scenes.ball.render]\nscan_conversion.slice_size = 64\n"
    "ray_casting = { image_size = 64, steps = 64 }\n";
const std::string kSettings =
    "[settings.paper]\n[settings.long.render.ray_casting]\nbuffer_length = 16\n";

TEST(AccuracyCommand, ScoresEverySettingOfEverySeed) {
  const ScratchFolder folder;
  folder.write("plan.toml", kPlan + kSettings);
  const auto result = bench({"accuracy", "plan.toml", "--json"}, folder);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = Json::parse(result.out);
  EXPECT_EQ(report.at("command"), "accuracy");
  EXPECT_EQ(report.at("accuracy").at("evaluations"), 4);
  EXPECT_EQ(report.at("scenes").at("ball").at("long").at("phantom").at("name"), "sphere");
  EXPECT_EQ(report.at("timing").at("accuracy").at("render_ms").size(), 2U);
  const Json& summaries = report.at("accuracy").at("summaries");
  EXPECT_EQ(summaries.at(0).at("setting"), "paper");
  EXPECT_EQ(summaries.at(0).at("means").at("p95_mm").at("n"), 2);
  EXPECT_GT(summaries.at(0).at("means").at("p95_mm").at("half_interval"), 0);
  for (const char* file : {"accuracy.csv",
                           "accuracy.md",
                           "accuracy_errors_field.vl.json",
                           "report.html",
                           "accuracy_ball_field_long.png",
                           "accuracy_ball_field_truth.png",
                           "report.json"}) {
    EXPECT_TRUE(fs::exists(folder.path() / "out" / file)) << file;
  }
}

TEST(AccuracyCommand, TakesOneSceneWithSettingsOfAnotherFile) {
  const ScratchFolder folder;
  folder.write("settings.toml", kSettings);
  const auto result =
      bench(with({"accuracy", "--settings", "settings.toml", "--seeds", "1", "--json"},
                 {kSphere, kScan, kPicture, {"--set", "simulation.fidelity=geometry"}}),
            folder);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = Json::parse(result.out);
  EXPECT_EQ(report.at("accuracy").at("evaluations"), 2);
  EXPECT_EQ(report.at("accuracy").at("summaries").at(0).at("rung"), "geometry");
}

/// A box of interest in the fluid in front of the ball: nothing to find, and nothing scored.
TEST(AccuracyCommand, SaysWhereNoSurfaceIsInView) {
  const ScratchFolder folder;
  const auto result = bench(with({"accuracy", "--seeds", "1", "--json"},
                                 {kSphere,
                                  kScan,
                                  kPicture,
                                  {"--set", "render.volume_of_interest.center_mm=[0,0,60]"},
                                  {"--set", "render.volume_of_interest.size_mm=[20,20,20]"}}),
                            folder);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json accuracy = Json::parse(result.out).at("accuracy");
  ASSERT_EQ(accuracy.at("notes").size(), 1U);
  EXPECT_NE(accuracy.at("notes").at(0).get<std::string>().find("no surface in view"),
            std::string::npos);
  const Json& means = accuracy.at("summaries").at(0).at("means");
  EXPECT_FALSE(means.contains("missed_percent"));
  EXPECT_FALSE(means.contains("p95_mm"));
}

TEST(AccuracyCommand, RefusesBadInputWithOneLineBeforeAnyWork) {
  const ScratchFolder folder;
  folder.write("plan.toml", kPlan + "[settings.bad.render.ray_casting]\nbuffer_length = 3\n");
  folder.write("none.toml", "seeds = 3\n[settings.paper]\n");
  for (const Words& words : {Words{"accuracy", "plan.toml"},
                             Words{"accuracy", "none.toml"},
                             Words{"accuracy", "missing.toml"},
                             Words{"accuracy", "--seeds", "-1"},
                             Words{"accuracy", "--settings", "missing.toml"}}) {
    const auto result = bench(words, folder);
    EXPECT_EQ(result.exit_code, 2) << words.back();
    EXPECT_EQ(result.err.find("wobblebench: "), 0U) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(folder.path() / "out")) << words.back();
  }
}

}  // namespace
}  // namespace wobblebench::bench
