#include "bench/scene.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/user_error.h"

namespace wobblebench::bench {
namespace {

namespace fs = std::filesystem;

class SceneFile : public testing::Test {
 protected:
  fs::path write(const std::string& text) {
    std::ofstream(path_) << text;
    return path_;
  }
  void TearDown() override { fs::remove(path_); }

  /// The message with which a scene of this text is refused; empty if it is not.
  std::string refusal(const std::string& text, const std::vector<std::string>& settings = {}) {
    try {
      load_scene(text.empty() ? fs::path() : write(text), settings);
    } catch (const UserError& error) {
      return error.what();
    }
    return {};
  }
  std::string file() const { return path_.string(); }

 private:
  const fs::path path_ =
      fs::path(testing::TempDir()) /
      (testing::UnitTest::GetInstance()->current_test_info()->name() + std::string(".toml"));
};

TEST_F(SceneFile, DefaultsAreThePapersAndAreValid) {
  const Scene scene = load_scene({}, {});
  EXPECT_EQ(scene.acquisition.frames_per_volume, 37);
  EXPECT_EQ(scene.acquisition.samples_per_stick, 512);
  EXPECT_NEAR(scene.acquisition.sector_rad, 77 * kDegree, 1e-15);
  EXPECT_NEAR(scene.acquisition.fan_rad, 61 * kDegree, 1e-15);
  EXPECT_EQ(scene.render.ray_casting.image_size, 512);
  EXPECT_EQ(scene.render.ray_casting.steps, 512);
  EXPECT_EQ(scene.render.ray_casting.kernel_3d, 3);
  EXPECT_EQ(scene.render.ray_casting.buffer_length, 8);
  EXPECT_EQ(scene.render.smoothing.filter_size, 9);
}

TEST_F(SceneFile, KeysCarryTheirUnits) {
  const Scene scene = load_scene(write("[acquisition]\ndepth_mm = 120\nsector_deg = 60.5\n"
                                       "[render.volume_of_interest]\ncenter_mm = [1, -2.5, 90]\n"
                                       "[simulation]\nfidelity = \"geometry\"\nspeckle = false\n"),
                                 {"probe.center_frequency_mhz=5", "phantom.name=plane"});
  EXPECT_NEAR(scene.acquisition.depth_m, 0.12, 1e-15);
  EXPECT_NEAR(scene.acquisition.sector_rad, 60.5 * kDegree, 1e-15);
  EXPECT_NEAR(scene.render.volume_of_interest.center_m.at(1), -2.5e-3, 1e-15);
  EXPECT_EQ(scene.simulation.fidelity, sim::Rung::geometry);
  EXPECT_FALSE(scene.simulation.speckle);
  EXPECT_NEAR(scene.probe.center_frequency_hz, 5e6, 1e-6);
  EXPECT_EQ(scene.phantom.name, "plane");
  EXPECT_TRUE(scene.given.contains("render.volume_of_interest.center_mm"));
  EXPECT_FALSE(scene.given.contains("render.volume_of_interest.size_mm"));
}

TEST_F(SceneFile, RefusalsNameFileKeyValueAndWhatIsAllowed) {
  EXPECT_EQ(refusal("[acquisition]\ndepth_mm = 900\n"),
            file() + ": acquisition.depth_mm = 900: must be within 1 and 400");
  EXPECT_EQ(refusal("[acquisition]\ndepth_mm = \"deep\"\n"),
            file() + ": acquisition.depth_mm = 'deep': must be a number");
  EXPECT_EQ(refusal("[acquisition]\nframes_per_volume = 3.5\n"),
            file() + ": acquisition.frames_per_volume = 3.5: must be a whole number");
  EXPECT_EQ(refusal("[simulation]\nfidelity = \"real\"\n"),
            file() + ": simulation.fidelity = 'real': must be one of \"geometry\" \"field\"");
  EXPECT_EQ(refusal("[simulation]\nseed = -1\n"),
            file() + ": simulation.seed = -1: must be a whole number, 0 or more");
  EXPECT_EQ(refusal("[render.ray_casting]\nkernel_3d = 4\n")
                .find(file() + ": render.ray_casting.kernel_3d = 4: "),
            0u);
  EXPECT_EQ(refusal("[render.volume_of_interest]\nsize_mm = [1, 2]\n"),
            file() + ": render.volume_of_interest.size_mm = 2 numbers: takes 3 numbers");
}

TEST_F(SceneFile, NumbersThatAreNoneAreRefused) {
  EXPECT_NE(refusal("[acquisition]\ndepth_mm = nan\n").find("acquisition.depth_mm = nan"),
            std::string::npos);
  EXPECT_NE(refusal("[acquisition]\ndepth_mm = inf\n").find("acquisition.depth_mm = inf"),
            std::string::npos);
  EXPECT_NE(refusal("[acquisition]\nvolumes = 99999999999\n").find("must be within"),
            std::string::npos);
}

TEST_F(SceneFile, UnknownNamesAreRefusedWithThoseThatExist) {
  const auto key = refusal("[acquisition]\ndeptn_mm = 100\n");
  EXPECT_EQ(key.find(file() +
                     ": acquisition.deptn_mm: unknown key; keys of [acquisition] are depth_mm, "),
            0u)
      << key;
  const auto section = refusal("[aquisition]\ndepth_mm = 100\n");
  EXPECT_EQ(section.find(file() + ": aquisition: unknown; sections are phantom, "), 0u) << section;
  EXPECT_NE(refusal("[render.ray_castin]\nsteps = 3\n").find("render.ray_castin: unknown"),
            std::string::npos);
  EXPECT_NE(refusal("depth_mm = 3\n").find("depth_mm: unknown"), std::string::npos);
  EXPECT_NE(refusal("[phantom]\nname = \"face\"\n").find("must be one of fetal_face"),
            std::string::npos);
}

TEST_F(SceneFile, BrokenTomlNamesTheLine) {
  EXPECT_EQ(refusal("[acquisition]\ndepth_mm = = 3\n").find(file() + ": line 2: "), 0u);
}

TEST_F(SceneFile, MissingFileIsNamed) {
  EXPECT_THROW(
      {
        try {
          load_scene("no/such/scene.toml", {});
        } catch (const UserError& error) {
          EXPECT_STREQ(error.what(), "no/such/scene.toml: no such file; a scene is a TOML file");
          throw;
        }
      },
      UserError);
}

TEST_F(SceneFile, SettingsAreHeldToTheSameRules) {
  EXPECT_EQ(refusal("", {"acquisition.depth_mm=900"}),
            "--set: acquisition.depth_mm = 900: must be within 1 and 400");
  EXPECT_EQ(refusal("", {"depth"}), "--set depth: must be SECTION.KEY=VALUE");
  EXPECT_EQ(refusal("", {"acquisition.depth_mm.x=1"}).find("--set"), 0u);
}

TEST_F(SceneFile, ResolvedSceneReadsBackAsItself) {
  const Scene scene = load_scene({}, {"acquisition.depth_mm=123.4", "render.view.yaw_deg=-33"});
  const auto json = resolved(scene);
  EXPECT_EQ(json["acquisition"]["depth_mm"], 123.4);
  EXPECT_EQ(json["render"]["view"]["yaw_deg"], -33);
  std::vector<std::string> settings;
  for (const auto& [section, options] : json.items()) {
    for (const auto& [key, value] : options.items()) {
      if (value.is_object()) {
        for (const auto& [inner, v] : value.items()) {
          settings.push_back(section + "." + key + "." + inner + "=" + v.dump());
        }
      } else {
        settings.push_back(section + "." + key + "=" + value.dump());
      }
    }
  }
  EXPECT_EQ(resolved(load_scene({}, settings)), json);
}

}  // namespace
}  // namespace wobblebench::bench
