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
  try {
    static_cast<void>(load_scene(scene, settings));
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

void expect_hint(const std::string& setting, const std::string& hint) {
  EXPECT_TRUE(refusal({setting}).ends_with("; did you mean " + hint + "?")) << refusal({setting});
}

TEST(Hints, NameTheKeySectionOrValueThatMayBeMeant) {
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

TEST(Hints, AreNotGivenWhereNothingIsNear) {
  EXPECT_EQ(refusal({"acquisition.weather=1"}).find("did you mean"), std::string::npos);
  EXPECT_EQ(refusal({"phantom.name=weather"}).find("did you mean"), std::string::npos);
}

/// What a shell makes of --set phantom.step_heights_mm=[1, 2] without quotes.
TEST(Hints, AListThatLostItsQuotesSaysHowToQuoteIt) {
  EXPECT_EQ(refusal({"phantom.step_heights_mm=[1,"}, "2]"),
            "--set phantom.step_heights_mm=[1,: its list is no TOML; in a shell, quote all of it: "
            "--set 'phantom.step_heights_mm=[1, 2]' or 'phantom.step_heights_mm=[\"a\", \"b\"]'");
  EXPECT_NE(refusal({"phantom.materials=[soft_tissue]"}).find("in a shell, quote all of it"),
            std::string::npos);
  EXPECT_EQ(refusal({"phantom.name=steps", "phantom.step_heights_mm=[1, 2]"}), "");
}

TEST(Names, OfGridsAndMaterialsThatDoNotExistAreRefusedWhateverThePhantom) {
  EXPECT_EQ(refusal({"phantom.name=sphere", "phantom.targets=[\"x\"]"}),
            "--set: phantom.targets = \"x\": no such grid: the phantom sphere has none to name; "
            "phantom.name = vdb has");
  EXPECT_NE(refusal({"phantom.grids=[\"x\"]"}).find("phantom.grids = \"x\": no such grid"),
            std::string::npos);
  EXPECT_NE(refusal({"phantom.materials=[\"cheese\"]"}).find("must be one of"), std::string::npos);
}

struct Slip {
  Words line;
  std::string said;
};

TEST(Hints, ACommandLineNamesWhatItDoesNotHave) {
  const ScratchFolder folder;
  for (const Slip& slip : std::vector<Slip>{
           {{"runn"}, "runn: no such command; did you mean run? ("},
           {{"weather"}, "weather: no such command ("},
           {{"run", "--registr"}, "--registr: no such option; did you mean --register? ("},
           {{"tune", "x.toml", "--limits=1"}, "--limits: no such option; did you mean --limit? ("},
           {{"tune", "x.toml", "--limit", "p95_m<=1"}, "--limit = p95_m: must be one of "}}) {
    const auto result = bench(slip.line, folder);
    EXPECT_EQ(result.exit_code, 2) << slip.said;
    EXPECT_TRUE(result.err.starts_with("wobblebench: " + slip.said)) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
}

TEST(Warnings, OfOptionsWithoutEffectAreOneLineAndAnEntryOfTheReport) {
  const ScratchFolder folder;
  const Words scene = with({"run"}, {kSphere, kScan, kPicture});
  const auto clean = bench(scene, folder);
  ASSERT_EQ(clean.exit_code, 0) << clean.err;
  EXPECT_EQ(clean.err.find("without effect"), std::string::npos) << clean.err;
  const auto warned = bench(
      with(scene,
           {{"--set", "render.ray_casting.threshold=0.3", "--set", "phantom.thickness_mm=4"}}),
      folder);
  ASSERT_EQ(warned.exit_code, 0) << warned.err;
  const std::string line =
      "without effect in this scene: phantom.thickness_mm (acts with phantom.name = bone_plate), "
      "render.ray_casting.threshold (acts with render.ray_casting.detector = paper, where a "
      "surface is sought)";
  EXPECT_NE(warned.err.find("wobblebench: warning: " + line + "\n"), std::string::npos)
      << warned.err;
  EXPECT_NE(bytes_of(folder.path() / "out/report.json").find("\"" + line + "\""),
            std::string::npos);
}

/// A scene whose mesh cannot be read: commands say what is without effect, and end there.
TEST(Warnings, OfOptionsWithoutEffectAreGivenByEveryCommandThatTakesAScene) {
  const ScratchFolder folder;
  folder.write("none.obj", "no mesh");
  for (const char* command : {"run",
                              "stream",
                              "record",
                              "accuracy",
                              "rungs",
                              "latency",
                              "modes",
                              "tables",
                              "fit",
                              "conformance",
                              "phantom"}) {
    const auto result = bench({command,
                               "--set",
                               "phantom.name=mesh",
                               "--set",
                               "phantom.file=none.obj",
                               "--set",
                               "phantom.radius_mm=30"},
                              folder);
    EXPECT_EQ(result.exit_code, 2) << command << result.err;
    EXPECT_NE(result.err.find("wobblebench: warning: without effect in this scene: "
                              "phantom.radius_mm (acts with phantom.name = sphere or cyst)\n"),
              std::string::npos)
        << command << ": " << result.err;
  }
}

TEST(Warnings, OfTheCommandLineNameOptionsThatDoNotActBesideOthers) {
  const ScratchFolder folder;
  folder.write("none.obj", "no mesh");
  const Words mesh = {"--set", "phantom.name=mesh", "--set", "phantom.file=none.obj"};
  const auto seeds = bench(
      with({"accuracy", "--seeds", "3", "--set", "simulation.fidelity=geometry"}, {mesh}), folder);
  EXPECT_NE(
      seeds.err.find("without effect: --seeds (acts with simulation.speckle, "
                     "simulation.noise_db or simulation.clutter, on the rung field or higher)"),
      std::string::npos)
      << seeds.err;
  const auto rendered = bench(
      with({"rungs", "--set", "render.ray_casting.steps=99", "--set", "motion.head_turn_deg=3"},
           {mesh}),
      folder);
  EXPECT_NE(rendered.err.find("motion.head_turn_deg (acts with run, stream and accuracy), "
                              "render.ray_casting.steps (acts with run, stream and accuracy)"),
            std::string::npos)
      << rendered.err;
  const Words small = {"--volumes", "2", "--codec", "none", "--errors", "0"};
  const auto queue =
      bench(with({"stream", "--queue", "3"}, {small, kSphere, kScan, kPicture}), folder);
  EXPECT_EQ(queue.exit_code, 0) << queue.err;
  EXPECT_NE(queue.err.find("without effect: --queue (acts with --policy every)"), std::string::npos)
      << queue.err;
  const auto cache = bench({"phantom", "--no-cache", "--cache-mb", "5"}, folder);
  EXPECT_EQ(cache.exit_code, 2);
  EXPECT_NE(cache.err.find("--no-cache excludes --cache-mb"), std::string::npos) << cache.err;
}

TEST(Warnings, OfARecordingNameTheSceneThatIsNotUsed) {
  const ScratchFolder folder;
  const Words recorded = {"--board", "file=rec/recording.wbst", "--set", "phantom.radius_mm=30"};
  ASSERT_EQ(bench(with({"record", "--out", "rec"}, {kSphere, kScan}), folder).exit_code, 0);
  const auto copied = bench(with({"record", "--out", "copy"}, {recorded}), folder);
  EXPECT_EQ(copied.exit_code, 0) << copied.err;
  EXPECT_NE(copied.err.find("phantom.radius_mm (acts with --board sim)"), std::string::npos)
      << copied.err;
}

}  // namespace
}  // namespace wobblebench::bench
