#include "bench/studies/fit/fit_scans.h"

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include "bench/evaluation/seed_statistics.h"
#include "render/geometry/ray_sampling.h"

namespace wobblebench::bench {

namespace {

constexpr int kHeldOutSeeds = 2;
constexpr double kTrainingView_rad = -20 * kDegree;
constexpr double kHeldOutView_rad = 25 * kDegree;
constexpr double kHeldOutPitch_rad = 15 * kDegree;

Scene turned(Scene scene, double about_x_rad, double about_y_rad) {
  scene.placement.rotation_rad += glm::dvec3(about_x_rad, about_y_rad, 0);
  return scene;
}

/// The scene with another phantom, at that phantom's default place.
Scene with_phantom(Scene scene, const phantoms::PhantomOptions& phantom) {
  scene.phantom = phantom;
  scene.placement = {};
  for (const char* key : {"placement.position_mm",
                          "placement.rotation_deg",
                          "render.volume_of_interest.center_mm",
                          "render.volume_of_interest.size_mm"}) {
    scene.given.erase(key);
  }
  return scene;
}

Scene with_plane(const Scene& scene, double tilt_x_rad, double tilt_y_rad) {
  phantoms::PhantomOptions plane{.name = "plane"};
  plane.tilt_x_rad = tilt_x_rad;
  plane.tilt_y_rad = tilt_y_rad;
  return with_phantom(scene, plane);
}

/// Half a line and half a frame to the side: the sticks meet other points of the surface.
Scene shifted(Scene scene, PhantomCache& cache) {
  scene = resolve_scene(scene, cache.phantom(scene.phantom)).options();
  const auto plan = scene.plan();
  const double range_m = plan.geometry().to_polar(scene.placement.position_m).range_m;
  const double line_m = (plan.geometry().radius_m() + range_m) * plan.theta_step_rad();
  const double frame_m = (plan.geometry().wobble_radius_m() + range_m) * plan.phi_step_rad();
  scene.placement.position_m += glm::dvec3(0.5 * line_m, 0.5 * frame_m, 0);
  scene.given.insert("placement.position_mm");
  return scene;
}

}  // namespace

LoadedPhantom load_phantom(const phantoms::PhantomOptions& options, PhantomCache& cache) {
  LoadedPhantom loaded{cache.phantom(options), {}};
  using Maps = std::map<double, std::shared_ptr<const sim::TissueMap>>;
  loaded.maps = [source = cache.tissue_maps(), kept = std::make_shared<Maps>()](
                    const phantoms::Phantom& phantom, double reach_m, int threads) {
    auto& map = (*kept)[reach_m];
    if (!map) map = source(phantom, reach_m, threads);
    return map;
  };
  return loaded;
}

ResolvedScene fit_scene(Scene scene, const phantoms::Phantom& phantom) {
  scene.render.ray_casting.image_size =
      std::min(scene.render.ray_casting.image_size, kFitImageSize);
  return resolve_scene(std::move(scene), phantom);
}

hw::PolarVolume scan_with_seed(const ResolvedScene& scene,
                               std::uint64_t seed,
                               const sim::TissueMapSource& maps) {
  Scene seeded = scene.options();
  seeded.simulation.seed = seed;
  return acquire_simulated(ResolvedScene(std::move(seeded), scene.subject()), maps).volume;
}

render::Picture render_frames(render::Renderer& renderer, const hw::PolarVolume& volume) {
  int index = 0;
  for (const hw::PolarFrame& frame : volume.frames()) renderer.add_frame(index++, frame);
  return renderer.render();
}

std::vector<sim::Rung> rungs_of_fit(const Scene& scene) {
  if (scene.simulation.fidelity != sim::Rung::automatic) return {scene.simulation.fidelity};
  return {sim::Rung::field, sim::Rung::scatterers};
}

std::vector<ScanSet> training_sets(const Scene& scene, int count) {
  std::vector<ScanSet> sets;
  std::uint64_t next = scene.simulation.seed;
  const auto add = [&](const std::string& name, Scene of) {
    sets.push_back({name, "training", std::move(of), seeds_from(next, count)});
    next += static_cast<std::uint64_t>(count);
  };
  auto buffer = scene, frames = scene, sticks = scene, view = scene;
  view.render.view.yaw_rad += kTrainingView_rad;
  frames.acquisition.frames_per_volume = std::max(2, scene.acquisition.frames_per_volume / 2);
  sticks.acquisition.sticks_per_frame = std::max(2, scene.acquisition.sticks_per_frame / 2);
  add("pose 1", scene);
  add("pose 2", turned(scene, 0, 12 * kDegree));
  add("pose 3", turned(scene, -10 * kDegree, -6 * kDegree));
  add("view", view);
  add("half the frames", frames);
  add("half the sticks", sticks);
  if (scene.render.ray_casting.detector == render::Detector::paper) {
    const int n = render::buffer_samples(buffer.render);
    buffer.render.ray_casting.buffer_length = n <= 32 ? 2 * n : n / 4 * 2;
    buffer.render.ray_casting.buffer_length_m = 0;
    add("buffer", buffer);
  }
  if (scene.phantom.name != "sphere") add("sphere", with_phantom(scene, {.name = "sphere"}));
  if (scene.phantom.name != "plane") {
    add("plane", with_plane(scene, 10 * kDegree, -8 * kDegree));
    add("steep plane", with_plane(scene, 0, 25 * kDegree));
  }
  return sets;
}

std::vector<std::vector<int>> folds_of(const std::vector<ScanSet>& training) {
  std::vector<std::vector<int>> folds;
  std::map<std::string, std::vector<int>> by_phantom;
  for (std::size_t i = 0; i < training.size(); ++i) {
    folds.push_back({static_cast<int>(i)});
    by_phantom[training[i].scene.phantom.name].push_back(static_cast<int>(i));
  }
  if (by_phantom.size() < 2) return folds;
  for (const auto& [name, sets] : by_phantom) {
    if (sets.size() > 1) folds.push_back(sets);
  }
  return folds;
}

std::vector<ScanSet> held_out_sets(const Scene& scene,
                                   const std::vector<std::pair<std::string, Scene>>& others,
                                   std::uint64_t first,
                                   PhantomCache& cache) {
  std::vector<ScanSet> sets;
  const auto add = [&](const std::string& name, const std::string& of, Scene with) {
    sets.push_back({name, of, std::move(with), seeds_from(first, kHeldOutSeeds)});
    first += kHeldOutSeeds;
  };
  Scene view = scene;
  view.render.view.yaw_rad += kHeldOutView_rad;
  view.render.view.pitch_rad += kHeldOutPitch_rad;
  add("seeds", "seeds", scene);
  add("pose", "seeds and pose", turned(scene, 8 * kDegree, -12 * kDegree));
  add("phase", "seeds and phase", shifted(scene, cache));
  add("view", "seeds and view", view);
  if (scene.phantom.name != "steps") {
    add("steps", "seeds and phantom", with_phantom(scene, {.name = "steps"}));
  }
  for (const auto& [name, other] : others) {
    Scene judged = with_phantom(scene, other.phantom);
    judged.placement = other.placement;
    for (const char* key : {"placement.position_mm", "placement.rotation_deg"}) {
      if (other.given.contains(key)) judged.given.insert(key);
    }
    add(name, "seeds and phantom", std::move(judged));
  }
  return sets;
}

}  // namespace wobblebench::bench
