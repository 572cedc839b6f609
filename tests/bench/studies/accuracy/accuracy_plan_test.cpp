// Plans of the command `accuracy`.
#include "bench/studies/accuracy/accuracy_plan.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/user_error.h"
#include "bench/exchange/program/renderer_process.h"
#include "tests/support/expect.h"
#include "tests/support/folder_test.h"

namespace wobblebench::bench {
namespace {

class PlanFile : public testing_support::FolderTest {
 protected:
  std::filesystem::path write(const std::string& text, const std::string& name = "plan.toml") {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  std::string refusal(const std::string& text) {
    return refusal_of<UserError>([&] {
      const AccuracyPlan plan = load_accuracy_plan(write(text));
      for (const auto& scene : plan.scenes) {
        for (const auto& setting : plan.settings) {
          for (const sim::Rung rung : plan.rungs) planned_scene(plan, scene, setting, rung, {});
        }
      }
    });
  }
};

const std::string kGood =
    "seeds = 3\nfirst_seed = 40\nrungs = [\"geometry\", \"field\"]\nreference = \"paper\"\n"
    "[scenes.ball.phantom]\nname = \"sphere\"\nradius_mm = 25\n"
    "[scenes.flat]\nphantom.name = \"plane\"\n"
    "[settings.long.render.ray_casting]\nbuffer_length = 32\ntransfer_values = [0, 0.5, 1]\n"
    "transfer_opacity_per_mm = [0, 0.1, 0.2]\ntransfer_grey = [0, 0.5, 1]\n"
    "[settings.paper]\n";

TEST_F(PlanFile, NamesScenesSettingsRungsAndSeeds) {
  const AccuracyPlan plan = load_accuracy_plan(write(kGood));
  EXPECT_EQ(plan.seeds, (std::vector<std::uint64_t>{40, 41, 42}));
  EXPECT_EQ(plan.rungs, (std::vector<sim::Rung>{sim::Rung::geometry, sim::Rung::field}));
  ASSERT_EQ(plan.scenes.size(), 2U);
  ASSERT_EQ(plan.settings.size(), 2U);
  EXPECT_EQ(plan.settings[0].name, "paper") << "the reference is first";
  const Scene scene = planned_scene(
      plan, plan.scenes[0], plan.settings[1], sim::Rung::field, {"render.ray_casting.steps=99"});
  EXPECT_EQ(scene.phantom.name, "sphere");
  EXPECT_NEAR(scene.phantom.radius_m, 25e-3, 1e-12);
  EXPECT_EQ(scene.render.ray_casting.buffer_length, 32);
  EXPECT_EQ(scene.render.ray_casting.transfer_values, (std::vector<double>{0, 0.5, 1}));
  EXPECT_EQ(scene.render.ray_casting.steps, 99);
  EXPECT_EQ(scene.simulation.fidelity, sim::Rung::field);
}

TEST_F(PlanFile, BeginsFromASceneBesideIt) {
  write("[acquisition]\nframes_per_volume = 11\n", "base.toml");
  const AccuracyPlan plan = load_accuracy_plan(
      write("[scenes.a]\nfile = \"base.toml\"\nacquisition.sticks_per_frame = 12\n[settings.s]\n"));
  const Scene scene = planned_scene(plan, plan.scenes[0], plan.settings[0], sim::Rung::field, {});
  EXPECT_EQ(scene.acquisition.frames_per_volume, 11);
  EXPECT_EQ(scene.acquisition.sticks_per_frame, 12);
}

TEST_F(PlanFile, SeeksFilesOfPhantomsBesideIt) {
  write("solid x\nendsolid x\n", "x.stl");
  const AccuracyPlan plan = load_accuracy_plan(
      write("[scenes.m.phantom]\nname = \"mesh\"\nfile = \"x.stl\"\n[settings.s]\n"));
  const Scene scene = planned_scene(plan, plan.scenes[0], plan.settings[0], sim::Rung::field, {});
  EXPECT_EQ(scene.phantom.file, (folder_ / "x.stl").string());
}

TEST_F(PlanFile, IsToldFromAScene) {
  EXPECT_TRUE(is_accuracy_plan(write(kGood)));
  EXPECT_FALSE(is_accuracy_plan(write("[phantom]\nname = \"plane\"\n")));
}

TEST_F(PlanFile, IsRefusedWithKeyAndWhatIsAllowed) {
  const std::string ball = "[scenes.ball]\nphantom.name = \"sphere\"\n", none = "[settings.s]\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {none, "scenes: must be one or more tables"},
      {ball, "settings: must be one or more tables"},
      {"seeds = 0\n" + ball + none, "plan.seeds = 0: must be within 1 and 1000"},
      {"seed = 3\n" + ball + none, "seed: unknown; keys of a plan are"},
      {"rungs = [\"best\"]\n" + ball + none, "rungs = best: must be of"},
      {"rungs = []\n" + ball + none, "rungs = []: must name one or more"},
      {"rungs = [\"field\", \"field\"]\n" + ball + none, "rungs = field: is there twice"},
      {"reference = \"x\"\n" + ball + none, "reference = \"x\": must be one of [settings]"},
      {"scenes = 3\n" + none, "scenes: must be one or more tables"},
      {"[scenes]\nball = 3\n" + none, "scenes.ball: must be a table"},
      {"[scenes.\"a/b\"]\nphantom.name = \"sphere\"\n" + none, "scenes.a/b: a name is 1 to 40"},
      {ball + "[settings.s.simulation]\nseed = 3\n", "settings.s.simulation: a setting holds"},
      {ball + "[settings.s.render.ray_casting]\nbuffer = 3\n", "buffer: unknown key"},
      {ball + "[settings.s.render.ray_casting]\nbuffer_length = 3\n", "buffer_length = 3: must be"},
      {ball + "simulation.seed = 3\n" + none, "simulation.seed: is set by the study itself"},
      {ball + "acquisition.volumes = 3\n" + none, "acquisition.volumes: must be 1"},
      {"[scenes.ball]\nfile = \"none.toml\"\n" + none, "no such file"},
      {"[scenes.ball]\nfile = 3\n" + none, "scenes.ball.file: must be a text"}};
  for (const auto& [text, words] : cases) {
    const std::string line = refusal(text);
    EXPECT_TRUE(holds(line, words)) << text << "\n";
    EXPECT_FALSE(holds(line, "\n"));
  }
}

TEST(RunCommand, StartsTheRendererThatASettingNames) {
  define_renderers({"first=python3 a.py --level '0.4'"});
  EXPECT_EQ(run_command_line({}, {"render.program=\"first\""}),
            "wobblebench run --set render.program=first "
            R"(--renderer 'first=python3 a.py --level '\''0.4'\''')");
  EXPECT_EQ(run_command_line({}, {"render.program=\"\""}),
            R"(wobblebench run --set 'render.program=""')");
}

}  // namespace
}  // namespace wobblebench::bench
