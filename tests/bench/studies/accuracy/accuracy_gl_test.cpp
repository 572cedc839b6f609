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

using AccuracyCommand = InFolder;

TEST_F(AccuracyCommand, ScoresEverySettingOfEverySeed) {
  folder_.write("plan.toml", kPlan + kSettings);
  const auto report = report_of(bench("accuracy plan.toml --json"));
  EXPECT_EQ(report.at("command"), "accuracy");
  EXPECT_EQ(report.at("accuracy").at("evaluations"), 4);
  EXPECT_EQ(report.at("scenes").at("ball").at("long").at("phantom").at("name"), "sphere");
  EXPECT_EQ(report.at("timing").at("accuracy").at("render_ms").size(), 2U);
  const Json& summaries = report.at("accuracy").at("summaries");
  EXPECT_EQ(summaries.at(0).at("setting"), "paper");
  EXPECT_EQ(summaries.at(0).at("means").at("p95_mm").at("n"), 2);
  EXPECT_GT(summaries.at(0).at("means").at("p95_mm").at("half_interval"), 0);
  for (const std::string& file :
       words_of("accuracy.csv accuracy.md accuracy_errors_field.vl.json report.html "
                "accuracy_ball_field_long.png accuracy_ball_field_truth.png report.json")) {
    EXPECT_TRUE(fs::exists(at("out") / file)) << file;
  }
}

TEST_F(AccuracyCommand, TakesOneSceneWithSettingsOfAnotherFile) {
  folder_.write("settings.toml", kSettings);
  const auto report =
      report_of(bench("accuracy --settings settings.toml --seeds 1 --json",
                      {kSphere, kScan, kPicture, set("simulation.fidelity=geometry")}));
  EXPECT_EQ(report.at("accuracy").at("evaluations"), 2);
  EXPECT_EQ(report.at("accuracy").at("summaries").at(0).at("rung"), "geometry");
}

/// A box of interest in the fluid in front of the ball: nothing to find, and nothing scored.
TEST_F(AccuracyCommand, SaysWhereNoSurfaceIsInView) {
  const auto accuracy = report_of(bench("accuracy --seeds 1 --json",
                                        {kSphere,
                                         kScan,
                                         kPicture,
                                         set("render.volume_of_interest.center_mm=[0,0,60] "
                                             "render.volume_of_interest.size_mm=[20,20,20]")}))
                            .at("accuracy");
  ASSERT_EQ(accuracy.at("notes").size(), 1U);
  EXPECT_TRUE(holds(accuracy.at("notes").at(0).get<std::string>(), "no surface in view"));
  const Json& means = accuracy.at("summaries").at(0).at("means");
  EXPECT_FALSE(means.contains("missed_percent"));
  EXPECT_FALSE(means.contains("p95_mm"));
}

TEST_F(AccuracyCommand, RefusesBadInputWithOneLineBeforeAnyWork) {
  folder_.write("plan.toml",
                kPlan + "[settings.paper]\n[settings.bad.render.ray_casting]\nbuffer_length = 3\n");
  folder_.write("none.toml", "seeds = 3\n[settings.paper]\n");
  expect_refusals({{"accuracy plan.toml", "buffer_length = 3: "},
                   {"accuracy none.toml", "none.toml: "},
                   {"accuracy missing.toml", "missing.toml: "},
                   {"accuracy --seeds -1", "--seeds = -1: "},
                   {"accuracy --settings missing.toml", "missing.toml: "}});
}

}  // namespace
}  // namespace wobblebench::bench
