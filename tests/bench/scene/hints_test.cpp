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

}  // namespace
}  // namespace wobblebench::bench
