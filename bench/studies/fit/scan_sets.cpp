#include "bench/studies/fit/scan_sets.h"

#include <algorithm>
#include <utility>

#include "bench/studies/validate/seeds.h"

namespace wobblebench::bench {

namespace {

constexpr int kHeldOutSeeds = 2;
constexpr std::uint64_t kHeldOutOffset = 200'000;
constexpr double kTrainingView_rad = -20 * kDegree;
constexpr double kHeldOutView_rad = 25 * kDegree;
Scene turned(Scene scene, double about_x_rad, double about_y_rad) {
  scene.placement.rotation_rad += glm::dvec3(about_x_rad, about_y_rad, 0);
  return scene;
}

ScanSet training_variant(const std::string& name, Scene scene, std::vector<std::uint64_t> seeds) {
  return {name, "training", std::move(scene), std::move(seeds)};
}

}  // namespace

std::vector<ScanSet> training_sets(const Scene& scene, int count) {
  const auto seeds = seeds_from(scene.simulation.seed, count);
  std::vector<ScanSet> sets = {
      training_variant("pose 1", scene, seeds),
      training_variant("pose 2", turned(scene, 0, 12 * kDegree), seeds),
      training_variant("pose 3", turned(scene, -10 * kDegree, -6 * kDegree), seeds)};
  const std::vector<std::uint64_t> few(seeds.begin(), seeds.begin() + (count + 1) / 2);
  auto buffer = scene, frames = scene, sticks = scene;
  Scene view = scene;
  view.render.view.yaw_rad += kTrainingView_rad;
  auto& n = buffer.render.ray_casting.buffer_length;
  n = n <= 32 ? 2 * n : n / 4 * 2;
  frames.acquisition.frames_per_volume = std::max(2, scene.acquisition.frames_per_volume / 2);
  sticks.acquisition.sticks_per_frame = std::max(2, scene.acquisition.sticks_per_frame / 2);
  sets.push_back(training_variant("view", view, few));
  sets.push_back(training_variant("buffer", buffer, few));
  sets.push_back(training_variant("half the frames", frames, few));
  sets.push_back(training_variant("half the sticks", sticks, few));
  return sets;
}

std::vector<ScanSet> held_out_sets(const Scene& scene) {
  const auto seeds = seeds_from(scene.simulation.seed + kHeldOutOffset, kHeldOutSeeds);
  Scene view = scene;
  view.render.view.yaw_rad += kHeldOutView_rad;
  return {{"seeds", "seeds", scene, seeds},
          {"pose", "seeds and pose", turned(scene, 8 * kDegree, -12 * kDegree), seeds},
          {"view", "seeds and view", view, seeds}};
}

std::vector<ScanSet> other_phantoms(const Scene& scene) {
  std::vector<ScanSet> sets;
  for (const char* name : {"sphere", "plane", "steps"}) {
    if (scene.phantom.name == name) continue;
    Scene other = scene;
    other.phantom = {.name = name};
    if (other.phantom.name == "plane") other.phantom.tilt_y_rad = 20 * kDegree;
    other.placement = {};
    for (const char* key : {"placement.position_mm",
                            "placement.rotation_deg",
                            "render.volume_of_interest.center_mm",
                            "render.volume_of_interest.size_mm"}) {
      other.given.erase(key);
    }
    const auto seeds = seeds_from(scene.simulation.seed + kHeldOutOffset, kHeldOutSeeds);
    sets.push_back({name, "seeds and phantom", std::move(other), seeds});
  }
  return sets;
}

}  // namespace wobblebench::bench
