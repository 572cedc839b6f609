// Options without effect: the table against what the program makes of each key.
#include "bench/scene/idle_options.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/user_error.h"
#include "bench/evaluation/truth/shadows.h"
#include "bench/pipeline/acquire.h"
#include "bench/scene/resolved_scene.h"
#include "bench/scene/scene.h"
#include "render/gl/context.h"
#include "render/renderer.h"
#include "tests/support/expect.h"

namespace wobblebench::bench {
namespace {

using Settings = std::vector<std::string>;

std::set<std::string> idle_keys(const Settings& settings,
                                SampleSource source = SampleSource::simulator) {
  const Scene scene = load_scene({}, settings);
  std::set<std::string> keys;
  for (const IdleOption& option : idle_options(scene, scene.given, source)) keys.insert(option.key);
  return keys;
}

using Keys = std::set<std::string>;

TEST(IdleOptions, AreNamedWithWhatTheyActWith) {
  const Scene scene = load_scene({}, {"render.ray_casting.threshold=0.3"});
  EXPECT_EQ(idle_options_text(idle_options(scene, scene.given)),
            "without effect in this scene: render.ray_casting.threshold (acts with "
            "render.ray_casting.detector = paper, where a surface is sought)");
  EXPECT_EQ(idle_options_text({}), "");
}

TEST(IdleOptions, FollowFromTheOtherOptions) {
  EXPECT_EQ(idle_keys({"phantom.radius_mm=30"}), Keys{"phantom.radius_mm"});
  EXPECT_EQ(idle_keys({"phantom.radius_mm=30", "phantom.name=sphere"}), Keys{});
  EXPECT_EQ(idle_keys({"render.view.eye_distance_mm=300"}), Keys{"render.view.eye_distance_mm"});
  EXPECT_EQ(idle_keys({"render.view.eye_distance_mm=300", "render.view.projection=perspective"}),
            Keys{});
  EXPECT_EQ(idle_keys({"simulation.clutter.haze_trail_mm=9"}),
            Keys{"simulation.clutter.haze_trail_mm"});
  EXPECT_EQ(idle_keys({"simulation.clutter.haze_trail_mm=9", "simulation.clutter.haze_db=-30"}),
            Keys{});
  EXPECT_EQ(idle_keys({"simulation.clutter.haze_db=-30", "simulation.fidelity=geometry"}),
            Keys{"simulation.clutter.haze_db"});
  EXPECT_EQ(idle_keys({"simulation.display.grey_bits=8", "simulation.output=linear"}),
            Keys{"simulation.display.grey_bits"});
  EXPECT_EQ(idle_keys({"simulation.scatterers_per_cell=20", "simulation.fidelity=field"}),
            Keys{"simulation.scatterers_per_cell"});
  EXPECT_EQ(idle_keys({"render.preset=baseline", "render.ray_casting.iso_level=0.5"}),
            Keys{"render.ray_casting.iso_level"});
  EXPECT_EQ(idle_keys({"render.ray_casting.threshold=0.3", "render.ray_casting.detector=paper"}),
            Keys{});
  EXPECT_EQ(idle_keys({"render.ray_casting.threshold_per_sample=0.04"}),
            Keys{"render.ray_casting.threshold_per_sample"});
  EXPECT_EQ(idle_keys({"render.ray_casting.threshold=0.15",
                       "render.ray_casting.threshold_per_sample=0.04",
                       "render.ray_casting.detector=paper"}),
            Keys{"render.ray_casting.threshold"});
}

TEST(IdleOptions, OfARecordingAreThoseOfTheSimulatorToo) {
  const Settings settings = {"simulation.noise_db=-60", "motion.velocity_mm_s=[1, 0, 0]"};
  EXPECT_EQ(idle_keys(settings), Keys{});
  EXPECT_EQ(idle_keys(settings, SampleSource::recording_of_scene), Keys{"simulation.noise_db"});
  EXPECT_EQ(idle_keys(settings, SampleSource::unknown_subject),
            (Keys{"simulation.noise_db", "motion.velocity_mm_s"}));
}

TEST(IdleOptions, OfSeveralScenesAreIdleInAll) {
  const Scene iso = load_scene({}, {"render.ray_casting.threshold=0.3", "phantom.radius_mm=30"});
  const Scene paper = load_scene({},
                                 {"render.ray_casting.threshold=0.3",
                                  "phantom.radius_mm=30",
                                  "render.ray_casting.detector=paper"});
  IdleInAll both;
  both.add(iso, iso.given);
  both.add(paper, paper.given);
  ASSERT_EQ(both.options().size(), 1U);
  EXPECT_EQ(both.options().front().key, "phantom.radius_mm");
}

/// What a scene comes to: samples, times, pictures and truth, as bytes.
class Outcomes {
 public:
  std::string of(const Settings& settings) {
    const Scene given = load_scene({}, settings);
    const std::string phantom = resolved(given)["phantom"].dump();
    if (phantom != made_) phantom_ = phantoms::make_phantom(given.phantom);
    made_ = phantom;
    const ResolvedScene scene = resolve_scene(given, phantom_);
    const Acquisition acquisition = acquire_simulated(scene);
    std::string bytes;
    for (int frame = 0; frame < scene.plan().acquisition().frames_per_volume; ++frame) {
      add(acquisition.volume.frame(frame).samples, bytes);
    }
    const auto duration = scene.plan().volume_duration().count();
    bytes += std::to_string(duration);
    const render::Picture picture =
        render::render_volume(*context_, acquisition.volume, scene.render());
    add(picture.depth_m.pixels, bytes);
    add(picture.filtered_depth_m.pixels, bytes);
    add(picture.surface.pixels, bytes);
    add(picture.volume.pixels, bytes);
    add(true_surface(scene, {}, 0).depth_m.pixels, bytes);
    return bytes;
  }

 private:
  template <class Range>
  static void add(const Range& range, std::string& bytes) {
    bytes.append(reinterpret_cast<const char*>(std::data(range)),
                 std::size(range) * sizeof(*std::data(range)));
  }
  std::unique_ptr<render::GlContext> context_ = render::make_context();
  std::optional<phantoms::Phantom> phantom_;
  std::string made_;
};

/// Other values of a key, of which the scene refuses some.
Settings other_values(const nlohmann::ordered_json& value) {
  if (value.is_boolean()) return {value.get<bool>() ? "false" : "true"};
  if (value.is_number_integer()) {
    const int v = value;
    return {std::to_string(v + 2), std::to_string(v - 2), std::to_string(v + 1)};
  }
  if (value.is_number()) {
    const double v = value;
    return {std::to_string(0.7 * v), std::to_string(1.3 * v), std::to_string(v + 3)};
  }
  if (value.is_array()) {
    auto scaled = value;
    for (auto& element : scaled) {
      if (element.is_number()) element = 0.8 * element.get<double>() + 0.02;
    }
    return {scaled.dump()};
  }
  return {"aligned",  "plain",    "r32f",   "volume",  "surface",   "slice",     "ray",
          "paper",    "iso",      "floor",  "falling", "rising",    "point",     "directional",
          "constant", "rendered", "guided", "box",     "bilateral", "parallel",  "perspective",
          "linear",   "log",      "tukey",  "nod",     "tilt",      "continuous"};
}

bool refused(const Settings& settings) {
  try {
    static_cast<void>(load_scene({}, settings));
    return false;
  } catch (const UserError&) {
    return true;
  }
}

const Settings kSmall = words_of(
    "phantom.voxel_mm=2 acquisition.frames_per_volume=7 acquisition.sticks_per_frame=16 "
    "acquisition.samples_per_stick=128 render.scan_conversion.slice_size=64 "
    "render.ray_casting.image_size=24 render.ray_casting.steps=64");

Settings joined(Settings first, const Settings& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

/// Each key of a scene with other values: where the table calls it idle, nothing changes.
class IdleSweep : public testing::TestWithParam<Settings> {};

TEST_P(IdleSweep, NothingChangesWhereTheTableCallsAKeyIdle) {
  const Settings base = joined(kSmall, GetParam());
  Outcomes outcomes;
  const std::string before = outcomes.of(base);
  std::string acts_and_changes_nothing;
  std::vector<std::pair<std::string, nlohmann::ordered_json>> keys;
  const auto collect = [&](const auto& self, const std::string& at, const auto& json) -> void {
    for (const auto& [name, value] : json.items()) {
      const std::string key = at.empty() ? name : at + "." + name;
      if (value.is_object()) {
        self(self, key, value);
      } else {
        keys.emplace_back(key, value);
      }
    }
  };
  collect(collect, "", resolved(load_scene({}, base)));
  ASSERT_GT(keys.size(), 100U);
  for (const auto& [key, value] : keys) {
    bool tried = false, changed = false;
    for (const std::string& other : other_values(value)) {
      const Settings settings = joined(base, {key + "=" + other});
      if (refused(settings)) continue;
      const bool is_idle = idle_keys(settings).contains(key);
      bool changes = false;
      try {
        changes = outcomes.of(settings) != before;
      } catch (const UserError&) {
        continue;  // refused for this phantom
      }
      tried = true;
      changed |= changes;
      EXPECT_FALSE(is_idle && changes) << key << " = " << other << " is said to be idle, and acts";
      if (!is_idle && changes) break;
    }
    if (tried && !changed && !idle_keys(joined(base, {key + "=" + value.dump()})).contains(key)) {
      acts_and_changes_nothing += " " + key;
    }
  }
  RecordProperty("acts_and_changes_nothing", acts_and_changes_nothing);
  std::printf("said to act, and changed nothing here:%s\n", acts_and_changes_nothing.c_str());
}

const Settings kBases[] = {
    {"phantom.name=sphere", "simulation.fidelity=geometry"},
    {"phantom.name=sphere",
     "render.preset=baseline",
     "render.view.projection=perspective",
     "render.smoothing.filter=guided"},
    {"phantom.name=plane", "simulation.fidelity=geometry", "render.ray_casting.mode=volume"}};

INSTANTIATE_TEST_SUITE_P(Bases, IdleSweep, testing::ValuesIn(kBases));

}  // namespace
}  // namespace wobblebench::bench
