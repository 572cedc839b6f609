// Whether mode fast renders the same picture as mode plain.
#include <algorithm>
#include <iostream>
#include <memory>

#include "base/user_error.h"
#include "bench/cache/phantom_cache.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/output/output_folder.h"
#include "bench/output/progress.h"
#include "bench/pipeline/acquire.h"
#include "bench/studies/modes/mode_agreement.h"
#include "bench/studies/modes/modes_report.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  SceneArguments scene;
  CacheArguments cache;
  OutputArguments output;
  std::string gl = "auto";
};

using Rows = std::vector<ModeAgreement>;

bool all_same(const Rows& rows) {
  return std::all_of(rows.begin(), rows.end(), [](const auto& row) { return row.depth.same(); });
}

/// The scene's own phantom where it names one, else four: curved, round, flat, and speckle without
/// a surface.
std::vector<std::string> phantoms_of(const Scene& scene) {
  if (scene.given.contains("phantom.name")) return {scene.phantom.name};
  return {"fetal_face", "sphere", "plane", "speckle_block"};
}

Rows measure_phantom(Scene scene,
                     const std::string& name,
                     PhantomCache& cache,
                     render::GlContext& context,
                     const PartDone& done) {
  scene.phantom.name = name;
  const ResolvedScene resolved = resolve_scene(scene, cache.phantom(scene.phantom));
  const Acquisition acquisition = acquire_simulated(resolved, cache.tissue_maps());
  return measure_mode_agreement(name, acquisition.volume, resolved.render(), context, done);
}

void refuse_compared_settings(const Scene& scene) {
  for (const char* key : {"render.pipeline.mode", "render.view.yaw_deg", "render.view.pitch_deg"}) {
    if (scene.given.contains(key)) {
      throw UserError(std::string(key) + ": is set by the comparison itself; leave it out");
    }
  }
  if (scene.render.ray_casting.mode == render::RenderMode::volume) {
    throw UserError("render.ray_casting.mode = \"volume\": must be surface or both; z is compared");
  }
}

int compare_modes(const Arguments& arguments) {
  const Scene scene = load_scene(
      arguments.scene.file, arguments.scene.settings, "--set", render::RenderPreset::paper);
  refuse_compared_settings(scene);
  const auto context = render::make_context(arguments.gl);
  OutputFolder out(arguments.output.folder);
  const auto names = phantoms_of(scene);
  std::vector<PlannedStep> steps;
  for (const std::string& name : names) steps.push_back({name, name == "fetal_face" ? 3.0 : 1.0});
  Progress progress(steps);
  PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
  Rows rows;
  for (const std::string& name : names) {
    const Rows more = progress.step(name, [&](const PartDone& done) {
      return measure_phantom(scene, name, cache, *context, done);
    });
    rows.insert(rows.end(), more.begin(), more.end());
  }
  const Provenance provenance = provenance_of_simulation(*context, scene.simulation.seed);
  const std::string markdown = modes_markdown(rows, scene, provenance);
  const std::string report = modes_report(rows, scene, provenance);
  out.write_text("modes.md", markdown);
  out.write_text("report.json", report);
  out.commit();
  std::cout << (arguments.output.json ? report : markdown);
  return all_same(rows) ? 0 : 1;
}

}  // namespace

Command add_modes_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = add_subcommand(
      app, "modes", "Whether mode fast makes mode plain's picture, phantom by phantom");
  add_scene_options(command, arguments->scene);
  add_cache_options(command, arguments->cache);
  add_output_options(command, arguments->output);
  add_gl_option(command, arguments->gl);
  return {&command, [arguments] { return compare_modes(*arguments); }};
}

}  // namespace wobblebench::bench
