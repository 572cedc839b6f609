// Hints for slips in a scene, a setting and a command line.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/user_error.h"
#include "bench/scene/scene.h"
#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

std::string refusal(const Words& settings, const fs::path& scene = {}) {
  return refusal_of<UserError>([&] { static_cast<void>(load_scene(scene, settings)); });
}

void expect_hint(const std::string& setting, const std::string& hint) {
  EXPECT_TRUE(refusal({setting}).ends_with("; did you mean " + hint + "?")) << refusal({setting});
}

using Hints = InFolder;

TEST_F(Hints, NameTheKeySectionOrValueThatMayBeMeant) {
  expect_hint("acquisition.deptn_mm=100", "depth_mm");
  expect_hint("render.threshold=0.3", "render.ray_casting.threshold");
  expect_hint("render.treshold=0.3", "render.ray_casting.threshold");
  expect_hint("phantom.depth_mm=100", "acquisition.depth_mm");
  expect_hint("aquisition.depth_mm=100", "acquisition");
  expect_hint("render.ray_cast.steps=100", "render.ray_casting");
  expect_hint("phantom.name=spere", "sphere");
  expect_hint("phantom.background=amniotic_fliud", "amniotic_fluid");
  expect_hint("probe.preset=c52v", "c5-2v");
  expect_hint("render.preset=acurate", "accurate");
}

TEST_F(Hints, AreNotGivenWhereNothingIsNear) {
  EXPECT_FALSE(holds(refusal({"acquisition.weather=1"}), "did you mean"));
  EXPECT_FALSE(holds(refusal({"phantom.name=weather"}), "did you mean"));
}

/// What a shell makes of --set phantom.step_heights_mm=[1, 2] without quotes.
TEST_F(Hints, AListThatLostItsQuotesSaysHowToQuoteIt) {
  EXPECT_EQ(refusal({"phantom.step_heights_mm=[1,"}, "2]"),
            "--set phantom.step_heights_mm=[1,: its list is no TOML; in a shell, quote all of it: "
            "--set 'phantom.step_heights_mm=[1, 2]' or 'phantom.step_heights_mm=[\"a\", \"b\"]'");
  EXPECT_TRUE(holds(refusal({"phantom.materials=[soft_tissue]"}), "in a shell, quote all of it"));
  EXPECT_EQ(refusal({"phantom.name=steps", "phantom.step_heights_mm=[1, 2]"}), "");
}

TEST(Names, OfGridsAndMaterialsThatDoNotExistAreRefusedWhateverThePhantom) {
  EXPECT_EQ(refusal({"phantom.name=sphere", "phantom.targets=[\"x\"]"}),
            "--set: phantom.targets = \"x\": no such grid: the phantom sphere has none to name; "
            "phantom.name = vdb has");
  EXPECT_TRUE(holds(refusal({"phantom.grids=[\"x\"]"}), "phantom.grids = \"x\": no such grid"));
  EXPECT_TRUE(holds(refusal({"phantom.materials=[\"cheese\"]"}), "must be one of"));
}

struct Slip {
  Words line;
  std::string said;
};

TEST_F(Hints, ACommandLineNamesWhatItDoesNotHave) {
  for (const Slip& slip : std::vector<Slip>{
           {{"runn"}, "runn: no such command; did you mean run? ("},
           {{"weather"}, "weather: no such command ("},
           {{"run", "--registr"}, "--registr: no such option; did you mean --register? ("},
           {words_of("tune x.toml --limits=1"),
            "--limits: no such option; did you mean --limit? ("},
           {words_of("tune x.toml --limit p95_m<=1"), "--limit = p95_m: must be one of "}}) {
    const auto result = bench(slip.line);
    EXPECT_EQ(result.exit_code, 2) << slip.said;
    EXPECT_TRUE(result.err.starts_with("wobblebench: " + slip.said)) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
}

using Warnings = InFolder;

TEST_F(Warnings, OfOptionsWithoutEffectAreOneLineAndAnEntryOfTheReport) {
  const Words scene = with({"run"}, {kSphere, kScan, kPicture});
  const auto clean = bench(scene);
  ASSERT_EQ(clean.exit_code, 0) << clean.err;
  EXPECT_FALSE(holds(clean.err, "without effect"));
  const auto warned =
      bench(with(scene, {set("render.ray_casting.threshold=0.3 phantom.thickness_mm=4")}));
  ASSERT_EQ(warned.exit_code, 0) << warned.err;
  const std::string line =
      "without effect in this scene: phantom.thickness_mm (acts with phantom.name = bone_plate), "
      "render.ray_casting.threshold (acts with render.ray_casting.detector = paper, where a "
      "surface is sought)";
  EXPECT_TRUE(holds(warned.err, "wobblebench: warning: " + line + "\n"));
  EXPECT_TRUE(holds(bytes_of(at("out/report.json")), "\"" + line + "\""));
}

/// A scene whose mesh cannot be read: commands say what is without effect, and end there.
TEST_F(Warnings, OfOptionsWithoutEffectAreGivenByEveryCommandThatTakesAScene) {
  folder_.write("none.obj", "no mesh");
  for (const std::string& command :
       words_of("run stream record accuracy rungs latency tables fit conformance phantom")) {
    expect_line(
        bench(command, {set("phantom.name=mesh phantom.file=none.obj phantom.radius_mm=30")}),
        2,
        "wobblebench: warning: without effect in this scene: "
        "phantom.radius_mm (acts with phantom.name = sphere or cyst)\n");
  }
}

TEST_F(Warnings, OfTheCommandLineNameOptionsThatDoNotActBesideOthers) {
  folder_.write("none.obj", "no mesh");
  const Words mesh = set("phantom.name=mesh phantom.file=none.obj");
  const auto seeds = bench("accuracy --seeds 3 --set simulation.fidelity=geometry", {mesh});
  EXPECT_TRUE(holds(seeds.err,
                    "without effect: --seeds (acts with simulation.speckle, "
                    "simulation.noise_db or simulation.clutter, on the rung field or higher)"));
  const auto rendered =
      bench("rungs --set render.ray_casting.steps=99 --set motion.head_turn_deg=3", {mesh});
  EXPECT_TRUE(holds(rendered.err,
                    "motion.head_turn_deg (acts with run, stream and accuracy), "
                    "render.ray_casting.steps (acts with run, stream and accuracy)"));
  const Words small = words_of("--volumes 2 --codec none --errors 0");
  expect_line(bench("stream --queue 3", {small, kSphere, kScan, kPicture}),
              0,
              "without effect: --queue (acts with --policy every)");
  expect_line(bench("phantom --no-cache --cache-mb 5"), 2, "--no-cache excludes --cache-mb");
}

TEST_F(Warnings, OfARecordingNameTheSceneThatIsNotUsed) {
  const Words recorded = words_of("--board file=rec/recording.wbst --set phantom.radius_mm=30");
  ASSERT_EQ(bench("record --out rec", {kSphere, kScan}).exit_code, 0);
  expect_line(
      bench("record --out copy", {recorded}), 0, "phantom.radius_mm (acts with --board sim)");
}

TEST_F(Warnings, OfARecordingAreNotOfWhatItWasMadeWith) {
  const Words seed = set("simulation.seed=7");
  ASSERT_EQ(bench("record --out rec", {kSphere, kScan, seed}).exit_code, 0);
  const std::string run = "run --board file=rec/recording.wbst --out ";
  const auto same = bench(run + "same", {kSphere, kPicture, seed});
  EXPECT_EQ(same.exit_code, 0) << same.err;
  EXPECT_FALSE(holds(same.err, "simulation.seed")) << same.err;
  expect_line(bench(run + "other", {kSphere, kPicture, set("simulation.seed=8")}),
              0,
              "without effect in this scene: simulation.seed (acts with --board sim)");
}

}  // namespace
}  // namespace wobblebench::bench
