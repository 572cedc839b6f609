#include "bench/scene/resolved_scene.h"
#include "bench/studies/accuracy/accuracy_plan.h"
#include "bench/studies/dataset/population_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/user_error.h"
#include "bench/scene/scene_cost.h"
#include "phantoms/grids.h"
#include "tests/support/expect.h"
#include "tests/support/process.h"

namespace wobblebench::bench {
namespace {

namespace fs = std::filesystem;

class SceneFile : public testing::Test {
 protected:
  fs::path write(const std::string& text) { return folder_.write("scene.toml", text); }

  /// The message with which a scene of this text is refused; empty if it is not.
  std::string refusal(const std::string& text, const std::vector<std::string>& settings = {}) {
    return refusal_of<UserError>(
        [&] { load_scene(text.empty() ? fs::path() : write(text), settings); });
  }
  std::string file() const { return folder_.path() / "scene.toml"; }

 private:
  const testing_support::ScratchFolder folder_;
};

TEST_F(SceneFile, DefaultsAreThePapersAndAreValid) {
  const Scene scene = load_scene({}, {});
  EXPECT_EQ(scene.acquisition.frames_per_volume, 37);
  EXPECT_EQ(scene.acquisition.samples_per_stick, 512);
  EXPECT_NEAR(scene.acquisition.sector_rad, 77 * kDegree, 1e-15);
  EXPECT_NEAR(scene.acquisition.fan_rad, 61 * kDegree, 1e-15);
  EXPECT_EQ(scene.render.ray_casting.image_size, 512);
  EXPECT_EQ(scene.render.ray_casting.steps, 256);  // the paper's are 512
  EXPECT_EQ(scene.render.ray_casting.kernel_3d, 3);
  EXPECT_EQ(scene.render.ray_casting.buffer_length, 8);
  EXPECT_EQ(scene.render.smoothing.filter_size, 9);
}

TEST_F(SceneFile, ScenesOfTheDocsAreValid) {
  int scenes = 0;
  for (const auto& entry :
       fs::directory_iterator(fs::path(WOBBLEBENCH_SOURCE_DIR) / "docs/scenes")) {
    if (entry.path().extension() != ".toml") continue;                // a list of scatterers
    if (entry.path().stem().string().starts_with("trade")) continue;  // read in trade_test.cpp
    if (entry.path().stem() == "compare") continue;                   // read in compare_test.cpp
    if (entry.path().stem().string().starts_with("population")) {
      EXPECT_NO_THROW(load_population_plan(entry.path())) << entry.path();
      continue;
    }
    ++scenes;
    if (!is_accuracy_plan(entry.path())) {
      EXPECT_NO_THROW(load_scene(entry.path(), {})) << entry.path();
      continue;
    }
    const AccuracyPlan plan = load_accuracy_plan(entry.path());
    for (const NamedOptions& scene : plan.scenes) {
      for (const NamedOptions& setting : plan.settings) {
        EXPECT_NO_THROW(planned_scene(plan, scene, setting, plan.rungs.front(), {}))
            << entry.path() << " " << scene.name << " " << setting.name;
      }
    }
  }
  EXPECT_GT(scenes, 0);
}

TEST_F(SceneFile, KeysCarryTheirUnits) {
  const Scene scene = load_scene(write("[acquisition]\ndepth_mm = 120\nsector_deg = 60.5\n"
                                       "[render.volume_of_interest]\ncenter_mm = [1, -2.5, 90]\n"
                                       "[simulation]\nfidelity = \"geometry\"\nspeckle = false\n"),
                                 {"probe.center_frequency_mhz=5", "phantom.name=plane"});
  EXPECT_NEAR(scene.acquisition.depth_m, 0.12, 1e-15);
  EXPECT_NEAR(scene.acquisition.sector_rad, 60.5 * kDegree, 1e-15);
  EXPECT_NEAR(scene.render.volume_of_interest.center_m.y, -2.5e-3, 1e-15);
  EXPECT_EQ(scene.simulation.fidelity, sim::Rung::geometry);
  EXPECT_FALSE(scene.simulation.speckle);
  EXPECT_NEAR(scene.probe.center_frequency_hz, 5e6, 1e-6);
  EXPECT_EQ(scene.phantom.name, "plane");
  EXPECT_TRUE(scene.given.contains("render.volume_of_interest.center_mm"));
  EXPECT_FALSE(scene.given.contains("render.volume_of_interest.size_mm"));
}

/// Wherever the preset stands, keys that are given override it.
TEST_F(SceneFile, SimulationStartsFromItsPreset) {
  const Scene clean = load_scene({}, {});
  EXPECT_EQ(clean.simulation.clutter.probe_reflection, 0);
  EXPECT_FALSE(clean.simulation.clutter.has_haze());
  EXPECT_EQ(clean.simulation.display.grey_bits, 0);
  const Scene scene = load_scene(write("[simulation]\nnoise_db = -80\npreset = \"clinical\"\n"
                                       "[simulation.clutter]\nhaze_trail_mm = 9\n"),
                                 {"simulation.display.line_filter=0.1"});
  EXPECT_EQ(scene.simulation.noise_db, -80);
  EXPECT_NEAR(scene.simulation.clutter.haze_trail_m, 9e-3, 1e-15);
  EXPECT_EQ(scene.simulation.display.line_filter, 0.1);
  EXPECT_EQ(scene.simulation.display.grey_bits, 8);
  EXPECT_GT(scene.simulation.clutter.probe_reflection, 0);
  EXPECT_TRUE(scene.simulation.clutter.has_haze());
  EXPECT_LT(scene.simulation.full_scale_db, clean.simulation.full_scale_db);
  const Scene again = load_resolved_scene(resolved(scene), {}, "report.json");
  EXPECT_EQ(resolved(again), resolved(scene));
  EXPECT_EQ(refusal("[simulation]\npreset = \"clinic\"\n"),
            file() +
                ": simulation.preset = 'clinic': must be one of \"clean\" \"clinical\"; did you "
                "mean clinical?");
  EXPECT_EQ(refusal("[simulation.clutter]\nparticles_per_cm3 = 50\n"),
            file() + ": simulation.clutter.particles_per_cm3 = 50: must be within 0 and 20");
}

/// A report names every option; commands set these themselves, or refuse them.
TEST_F(SceneFile, AReportChoosesNoRungNoSeedAndNotItsOneVolume) {
  const fs::path report = fs::path(file()).replace_filename("report.json");
  std::ofstream(report) << nlohmann::ordered_json{{"scene", resolved(Scene())}};
  for (const char* key :
       {"acquisition.volumes", "simulation.fidelity", "simulation.seed", "simulation.side_lobes"}) {
    EXPECT_FALSE(load_scene(report, {}).given.contains(key)) << key;
  }
  EXPECT_FALSE(is_accuracy_plan(report));
  EXPECT_TRUE(load_scene(report, {"simulation.seed=3"}).given.contains("simulation.seed"));
  std::ofstream(report) << nlohmann::ordered_json{
      {"scene", resolved(load_scene({}, {"acquisition.volumes=4"}))}};
  EXPECT_TRUE(load_scene(report, {}).given.contains("acquisition.volumes"));
}

TEST_F(SceneFile, RefusalsNameFileKeyValueAndWhatIsAllowed) {
  EXPECT_EQ(refusal("[acquisition]\ndepth_mm = 900\n"),
            file() + ": acquisition.depth_mm = 900: must be within 1 and 400");
  EXPECT_EQ(refusal("[acquisition]\ndepth_mm = \"deep\"\n"),
            file() + ": acquisition.depth_mm = 'deep': must be a number");
  EXPECT_EQ(refusal("[acquisition]\nframes_per_volume = 3.5\n"),
            file() + ": acquisition.frames_per_volume = 3.5: must be a whole number");
  EXPECT_EQ(refusal("[simulation]\nfidelity = \"real\"\n"),
            file() +
                ": simulation.fidelity = 'real': must be one of \"auto\" \"geometry\" \"field\" "
                "\"scatterers\" \"reference\"");
  EXPECT_EQ(refusal("[simulation]\nseed = -1\n"),
            file() + ": simulation.seed = -1: must be a whole number, 0 or more");
  EXPECT_EQ(refusal("[render.ray_casting]\nkernel_3d = 4\n")
                .find(file() + ": render.ray_casting.kernel_3d = 4: "),
            0u);
  EXPECT_EQ(refusal("[render.volume_of_interest]\nsize_mm = [1, 2]\n"),
            file() + ": render.volume_of_interest.size_mm = 2 numbers: takes 3 numbers");
}

TEST_F(SceneFile, NumbersThatAreNoneAreRefused) {
  EXPECT_TRUE(holds(refusal("[acquisition]\ndepth_mm = nan\n"), "acquisition.depth_mm = nan"));
  EXPECT_TRUE(holds(refusal("[acquisition]\ndepth_mm = inf\n"), "acquisition.depth_mm = inf"));
  EXPECT_TRUE(holds(refusal("[acquisition]\nvolumes = 99999999999\n"), "must be within"));
}

TEST_F(SceneFile, UnknownNamesAreRefusedWithThoseThatExist) {
  const auto key = refusal("[acquisition]\ndeptn_mm = 100\n");
  EXPECT_EQ(key.find(file() +
                     ": acquisition.deptn_mm: unknown key; keys of [acquisition] are depth_mm, "),
            0u)
      << key;
  const auto section = refusal("[aquisition]\ndepth_mm = 100\n");
  EXPECT_EQ(section.find(file() + ": aquisition: unknown; sections are phantom, "), 0u) << section;
  EXPECT_TRUE(holds(refusal("[render.ray_castin]\nsteps = 3\n"), "render.ray_castin: unknown"));
  EXPECT_TRUE(holds(refusal("depth_mm = 3\n"), "depth_mm: unknown"));
  EXPECT_TRUE(holds(refusal("[phantom]\nname = \"face\"\n"), "must be one of fetal_face"));
}

TEST_F(SceneFile, BrokenTomlNamesTheLine) {
  EXPECT_EQ(refusal("[acquisition]\ndepth_mm = = 3\n").find(file() + ": line 2: "), 0u);
}

TEST_F(SceneFile, WhatIsNoFileIsSaidToBeNone) {
  const auto message = [](const fs::path& path) {
    return refusal_of<UserError>([&] { load_scene(path, {}); });
  };
  EXPECT_EQ(message("no/scene.toml"), "no/scene.toml: no such file; a scene is a TOML file");
  EXPECT_EQ(message("/"), "/: not a file; a scene is a TOML file");
  const std::string long_name(300, 'a');
  EXPECT_EQ(message(long_name), long_name + ": File name too long; a scene is a TOML file");
}

TEST_F(SceneFile, ErrorsStayOnOneLine) {
  EXPECT_EQ(std::string(UserError("a\nb\tc\x7f").what()), "a\\nb\\x09c\\x7f");
  EXPECT_EQ(std::string(UserError("f\xc3\xb6tus").what()), "f\xc3\xb6tus") << "UTF-8 stays";
  EXPECT_EQ(std::string(UserError("\xc3(").what()), "\\xc3(") << "what is none does not";
  EXPECT_FALSE(holds(refusal("[phantom]\nname = \"a\\nb\"\n"), "\n"));
}

TEST_F(SceneFile, SettingsArePrintableText) {
  EXPECT_EQ(refusal("", {"phantom.file=\xff"}),
            "--set phantom.file=\\xff: must be UTF-8 without control characters");
  // TOML would take this for two settings, and the second would be lost.
  EXPECT_NE(refusal("", {"phantom.voxel_mm=1\nother=2"}), "");
  EXPECT_EQ(load_scene({}, {"phantom.file=f\xc3\xb6tus.vdb"}).phantom.file, "f\xc3\xb6tus.vdb");
}

TEST_F(SceneFile, PhantomsAreRefusedWithFileAndSection) {
  EXPECT_EQ(refusal("[phantom]\nname = \"sphere\"\nradius_mm = 5\nvoxel_mm = 4\n"),
            file() + ": phantom.voxel_mm = 4: must be at most 2.5 for the phantom sphere");
  EXPECT_EQ(refusal("[phantom]\nname = \"file\"\nfile = \"no.vdb\"\n"),
            file() + ": phantom.file = \"no.vdb\": no such file");
}

TEST_F(SceneFile, TheTiniestNumbersAreReported) {
  const Scene scene = load_scene({}, {"phantom.tilt_x_deg=1e-310"});
  EXPECT_NEAR(resolved(scene)["phantom"]["tilt_x_deg"].get<double>(), 0, 1e-300);
}

phantoms::Phantom empty_phantom(const phantoms::Box& box) {
  return {"none",
          phantoms::material_table(),
          0,
          {},
          box,
          {0, 0, 0.1},
          std::make_shared<phantoms::Grids>()};
}

TEST_F(SceneFile, BoxOfInterestHoldsTheTurnedBoxOfThePhantom) {
  const auto phantom = empty_phantom({{-0.01, -0.02, -0.03}, {0.05, 0.02, 0.07}});
  const Scene given = load_scene({}, {"placement.rotation_deg=[0, 90, 0]"});
  const ResolvedScene scene = resolve_scene(given, phantom);
  // About y, z turns to x and x to -z.
  const auto& box = scene.render().volume_of_interest;
  const glm::dvec3 size(0.10, 0.04, 0.06), center(0.02, 0, 0.1 - 0.02);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(box.size_m[axis], size[axis], 1e-15);
    EXPECT_NEAR(box.center_m[axis], center[axis], 1e-15);
  }
}

TEST_F(SceneFile, BoxOfInterestOfATiltedPhantomHoldsItsCorners) {
  const auto phantom = empty_phantom({{-0.01, -0.01, -0.01}, {0.01, 0.01, 0.01}});
  const Scene given = load_scene({}, {"placement.rotation_deg=[0, 0, 45]"});
  const ResolvedScene scene = resolve_scene(given, phantom);
  const auto& size = scene.render().volume_of_interest.size_m;
  EXPECT_NEAR(size.x, 0.02 * std::sqrt(2), 1e-15);
  EXPECT_NEAR(size.z, 0.02, 1e-15);
}

TEST_F(SceneFile, MemoryNeedIsThatOfTheLargestArrays) {
  const std::vector<std::string> small = words_of(
      "acquisition.frames_per_volume=10 acquisition.sticks_per_frame=20 "
      "acquisition.samples_per_stick=100 render.preset=baseline "
      "render.scan_conversion.slice_size=32 render.scan_conversion.format=r32f");
  auto geometry = small;
  geometry.push_back("simulation.fidelity=geometry");
  // The volume in transit, and the assembled volume: 4 bytes a sample each.
  EXPECT_EQ(memory_need(load_scene({}, geometry)).acquisition, 2 * 4 * 20000);
  EXPECT_EQ(memory_need(load_scene({}, geometry)).slices, 32 * 32 * 10 * 4 + 2 * 4 * 20000);
  // Aligned: of the sticks between them, too, 8 steps from each to the next.
  geometry.push_back("render.reconstruction.sticks=aligned");
  geometry.push_back("render.reconstruction.spacing_mm=0.1");
  EXPECT_EQ(memory_need(load_scene({}, geometry)).slices,
            32 * 32 * 73 * 4 + 4 * 20000 + 4 * 73 * 153 * 100);
  // The pulse's band needs ceil(2.2 * 2.1 MHz / (1540 m/s / 2 / 1.6 mm)) = 10 IQ samples a sample,
  // 8 bytes each: of homogeneous speckle, and of the echoes computed from it.
  const double iq = 10 * 8 * 20000, volumes = 2 * 4 * 20000;
  // Losses of the ways beside a stick at each of 21 nodes: two floats of each volume kept, seven
  // while one is computed.
  const auto losses = [](int kept) { return (2 * kept + 7) * 4.0 * 21 * 200; };
  EXPECT_EQ(memory_need(load_scene({}, small)).acquisition, 2 * iq + losses(1));
  // Echoes that differ from volume to volume are not kept.
  const auto with = [&](const std::string& setting) {
    auto settings = small;
    settings.push_back(setting);
    return memory_need(load_scene({}, settings)).acquisition;
  };
  EXPECT_EQ(with("acquisition.motor=alternating"), iq + volumes + losses(3));
  EXPECT_EQ(with("simulation.fidelity=scatterers"), iq + volumes);
  EXPECT_EQ(with("motion.velocity_mm_s=[0,0,1]"), volumes + losses(3));
}

TEST_F(SceneFile, MoreMemoryThanTheMachineHasIsRefused) {
  Scene scene = load_scene({}, {"simulation.fidelity=geometry", "render.preset=baseline"});
  scene.acquisition.frames_per_volume = 1000;
  scene.acquisition.samples_per_stick = 500;
  const auto refused = [&](double available) {
    return refusal_of<UserError>([&] { check_memory(scene, "a.toml", available); });
  };
  EXPECT_EQ(refused(1e9), "");
  EXPECT_EQ(refused(600e6),
            "a.toml: acquisition.frames_per_volume = 1000, render.scan_conversion.slice_size = "
            "512: need about 0.78 GB of memory; there are 0.6 GB");
  EXPECT_EQ(refused(200e6),
            "a.toml: acquisition.frames_per_volume = 1000, acquisition.sticks_per_frame = 64, "
            "acquisition.samples_per_stick = 500: need about 0.256 GB of memory; there are "
            "0.2 GB");
}

TEST_F(SceneFile, MotionIsReadWithItsUnits) {
  const Scene scene = load_scene(write("[motion]\nvelocity_mm_s = [1, -2, 3.5]\n"
                                       "breath_amplitude_mm = 4\nhead_axis = \"nod\"\n"),
                                 {"motion.turn_rate_deg_s=[0,90,0]"});
  EXPECT_EQ(scene.motion.velocity_m_s, glm::dvec3(1e-3, -2e-3, 3.5e-3));
  EXPECT_NEAR(scene.motion.turn_rate_rad_s.y, 90 * kDegree, 1e-15);
  EXPECT_NEAR(scene.motion.breath_amplitude_m, 4e-3, 1e-18);
  EXPECT_EQ(scene.motion.head_axis, phantoms::HeadAxis::nod);
  EXPECT_TRUE(scene.moves());
  EXPECT_FALSE(load_scene({}, {}).moves());
  EXPECT_TRUE(load_scene({}, {"motion.head_turn_deg=5"}).moves());
  EXPECT_EQ(resolved(scene)["motion"]["velocity_mm_s"], (std::vector<double>{1, -2, 3.5}));
}

TEST_F(SceneFile, MotionThatCannotBeIsRefused) {
  EXPECT_EQ(refusal("[motion]\nvelocity_mm_s = [1, 2]\n"),
            file() + ": motion.velocity_mm_s = 2 numbers: takes 3 numbers");
  EXPECT_EQ(refusal("[motion]\nvelocity_mm_s = [1, 2, 501]\n"),
            file() + ": motion.velocity_mm_s = 501: must be within -500 and 500");
  EXPECT_EQ(refusal("[motion]\nvelocity_mm_s = [1, 2, nan]\n"),
            file() + ": motion.velocity_mm_s = nan: must be within -500 and 500");
  EXPECT_EQ(refusal("[motion]\nvelocity_mm_s = [1, 2, \"3\"]\n"),
            file() + ": motion.velocity_mm_s = [...]: must be a list of numbers");
  EXPECT_EQ(refusal("[motion]\nbreath_period_s = 0\n"),
            file() + ": motion.breath_period_s = 0: must be within 0.1 and 60");
  EXPECT_EQ(refusal("[motion]\nhead_axis = \"roll\"\n"),
            file() + ": motion.head_axis = 'roll': must be one of \"nod\" \"shake\" \"tilt\"");
}

TEST_F(SceneFile, AHeadThatIsNotThereDoesNotTurn) {
  const std::string box = "render.volume_of_interest.size_mm=[80, 80, 60]";
  const Scene scene = load_scene({}, {"phantom.name=sphere", "motion.head_turn_deg=10", box});
  const auto phantom = empty_phantom({});  // which frames no picture
  const std::string refusal = refusal_of<UserError>([&] { resolve_scene(scene, phantom); });
  EXPECT_TRUE(refusal.starts_with("motion.head_turn_deg = 10: ")) << refusal;
  EXPECT_TRUE(resolve_scene(load_scene({}, {box}), phantom).subject()->motion.still());
}

TEST_F(SceneFile, APresetGivesTheDefaultsOfTheProbeAndItsSector) {
  const Scene scene = load_scene(
      write("[acquisition]\ndepth_mm = 140\n[probe]\nf_number = 3\npreset = \"c5-2v\"\n"), {});
  EXPECT_NEAR(scene.probe.radius_m, 49.57e-3, 1e-15);
  EXPECT_NEAR(scene.probe.center_frequency_hz, 3.57e6, 1e-6);
  EXPECT_EQ(scene.probe.f_number, 3) << "a key beside the preset overrides it, in any order";
  EXPECT_NEAR(scene.acquisition.sector_rad, 74.6 * kDegree, 0.05 * kDegree);
  EXPECT_NEAR(scene.acquisition.depth_m, 0.14, 1e-15);
  EXPECT_NEAR(load_scene({}, {"probe.preset=curvilinear-60", "acquisition.sector_deg=40"})
                  .acquisition.sector_rad,
              40 * kDegree,
              1e-15);
  EXPECT_TRUE(load_scene({}, {"probe.preset=default"}).probe ==
              static_cast<const hw::ProbeOptions&>(load_scene({}, {}).probe));
}

TEST_F(SceneFile, AnUnknownPresetIsRefusedWithThoseThatExist) {
  EXPECT_EQ(refusal("", {"probe.preset=c5-1"}),
            "--set: probe.preset = 'c5-1': must be one of \"default\" \"c5-2v\" "
            "\"curvilinear-60\"; did you mean c5-2v?");
  EXPECT_TRUE(holds(refusal("[probe]\npreset_source = \"me\"\n"), "probe.preset_source = 'me'"));
}

TEST_F(SceneFile, ResolvedSceneNamesPresetAndSource) {
  for (const std::string preset : {"default", "c5-2v", "curvilinear-60"}) {
    const auto json = resolved(load_scene({}, {"probe.preset=" + preset}));
    EXPECT_EQ(json["probe"]["preset"], preset);
    EXPECT_TRUE(holds(json["probe"]["preset_source"].get<std::string>(), "assumed: "));
    EXPECT_TRUE(json["probe"]["radius_mm"].is_number());
  }
}

TEST_F(SceneFile, WhatARungCannotShowIsRefused) {
  EXPECT_EQ(refusal("", {"simulation.fidelity=field", "simulation.side_lobes=true"})
                .find("--set: simulation.side_lobes = true: needs the rung scatterers"),
            0u);
}

TEST_F(SceneFile, SettingsAreHeldToTheSameRules) {
  EXPECT_EQ(refusal("", {"acquisition.depth_mm=900"}),
            "--set: acquisition.depth_mm = 900: must be within 1 and 400");
  EXPECT_EQ(refusal("", {"depth"}), "--set depth: must be SECTION.KEY=VALUE");
  EXPECT_EQ(refusal("", {"acquisition.depth_mm.x=1"}).find("--set"), 0u);
}

TEST_F(SceneFile, ResolvedSceneReadsBackAsItself) {
  const Scene scene = load_scene(
      {},
      words_of("acquisition.depth_mm=123.4 render.view.yaw_deg=-33 probe.preset=c5-2v "
               "probe.f_number=3 acquisition.motor=fly_back motion.velocity_mm_s=[1,2,3]"));
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

/// On the face, at the edges and in the middle of the sector: docs/units.md.
TEST_F(SceneFile, WithoutAPhantomTheVolumeOfInterestIsTheScannedSector) {
  const ResolvedScene scene = resolve_scene(load_scene({}, {}), std::nullopt);
  const double a = 0.04, b = 0.04 - 0.027, end = 0.04 + 0.16;
  const double half_sector = 38.5 * kDegree, half_fan = 30.5 * kDegree;
  const double low_z = b + (a * std::cos(half_sector) - b) * std::cos(half_fan);
  const auto& box = scene.render().volume_of_interest;
  EXPECT_NEAR(box.size_m.x, 2 * end * std::sin(half_sector), 1e-12);
  EXPECT_NEAR(box.size_m.y, 2 * (end - b) * std::sin(half_fan), 1e-12);
  EXPECT_NEAR(box.size_m.z, end - low_z, 1e-12);
  EXPECT_NEAR(box.center_m.x, 0, 1e-12);
  EXPECT_NEAR(box.center_m.y, 0, 1e-12);
  EXPECT_NEAR(box.center_m.z, 0.5 * (end + low_z), 1e-12);
}

/// The refusal named a key of the section simulation, which has none.
TEST_F(SceneFile, ARuleOfTheAcquisitionIsRefusedByItsOwnSection) {
  const std::string text =
      refusal("[acquisition]\nfocal_zones = 8\ndead_time_us = 9999\ndepth_mm = 400\n");
  EXPECT_TRUE(holds(text, ": acquisition.focal_zones = 8: "));
}

/// It was refused for a size that nobody had given.
TEST_F(SceneFile, TheVolumeOfInterestOfTheNarrowestScanIsAllowed) {
  const Scene given = load_scene(
      {}, {"acquisition.sector_deg=0.1", "acquisition.fan_deg=0.1", "acquisition.depth_mm=1"});
  const ResolvedScene scene = resolve_scene(given, std::nullopt);
  EXPECT_NO_THROW(render::validate(scene.render()));
  EXPECT_NEAR(scene.render().volume_of_interest.center_m.z, 0.0405, 1e-5);
}

TEST_F(SceneFile, AVolumeOfInterestThatWasGivenStaysAndTheWidestIsAllowed) {
  Scene scene = load_scene({},
                           {"render.volume_of_interest.size_mm=[50,60,70]",
                            "probe.radius_mm=200",
                            "acquisition.depth_mm=400",
                            "acquisition.sector_deg=170"});
  EXPECT_EQ(resolve_scene(scene, std::nullopt).render().volume_of_interest.size_m,
            glm::dvec3(0.05, 0.06, 0.07));
  scene.given.clear();
  EXPECT_NO_THROW(render::validate(resolve_scene(scene, std::nullopt).render()));
}

}  // namespace
}  // namespace wobblebench::bench
