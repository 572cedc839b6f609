// Whether mode fast renders the same picture as mode plain.
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "base/user_error.h"
#include "bench/cache/phantom_cache.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"
#include "bench/command/software_renderer.h"
#include "bench/output/report.h"
#include "bench/pipeline/acquire.h"
#include "bench/pipeline/scene_warnings.h"
#include "bench/studies/modes/mode_agreement.h"
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

std::vector<Scene> scenes_of(const Scene& scene, const std::vector<std::string>& phantoms) {
  std::vector<Scene> scenes;
  for (const std::string& name : phantoms) scenes.emplace_back(scene).phantom.name = name;
  return scenes;
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
  refuse_correction(scene, "modes");
  refuse_program(scene, "modes");
  if (scene.render.ray_casting.mode == render::RenderMode::volume) {
    throw UserError("render.ray_casting.mode = \"volume\": must be surface or both; z is compared");
  }
}

std::string origin_of(const Provenance& provenance) {
  return "Written by `wobblebench modes`. CPU: " + provenance.cpu + ", " +
         std::to_string(provenance.threads) + " threads. GL: " + provenance.gl_backend + ", " +
         provenance.gl_renderer + ". Commit: " + provenance.commit +
         ". Seed: " + std::to_string(provenance.seed) + ". Sticks: simulated.";
}

std::string method_of(const render::RayCastingOptions& o) {
  std::ostringstream text;
  text << "One volume of each phantom, " << o.image_size << "² rays of " << o.steps
       << " steps; the " << o.kernel_3d << "³ kernel lies "
       << (o.kernel_space == render::KernelSpace::slice ? "in the slices" : "along the ray")
       << " in both modes. z: ray length at the surface, in steps. Changed: pixels where one mode "
          "alone found a surface, and those where both did, but more than "
       << kSameSurfaceSteps
       << " step apart: there Difference meets the threshold within rounding, and the ray goes on "
          "to another edge. Asked: z within "
       << kMostRmsSteps << " steps RMS, and " << kMostChangedPercent
       << " % of the pixels changed at most. The last columns leave nothing out.";
  return text.str();
}

Table modes_table(const Rows& rows) {
  constexpr int kDigits = 2;
  Table table{.name = "modes",
              .columns = {{"phantom"},
                          {"from"},
                          {"yaw_deg", "yaw", "deg", 0},
                          {"pitch_deg", "pitch", "deg", 0},
                          {"pixels"},
                          {"both_hit", "found by both"},
                          {"one_hit", "by one"},
                          {"elsewhere"},
                          {"changed_percent", "changed", "%", kDigits, true},
                          {"rms_steps", "RMS", "steps", kDigits, true},
                          {"outcome"},
                          {"rms_all_steps", "RMS of all", "steps", kDigits, true},
                          {"worst_steps", "greatest", "steps", kDigits, true}}};
  for (const ModeAgreement& row : rows) {
    const DepthAgreement& d = row.depth;
    table.add({row.phantom,
               row.direction.name,
               row.direction.yaw_rad / kDegree,
               row.direction.pitch_rad / kDegree,
               d.pixels,
               d.both_hit,
               d.one_hit,
               d.elsewhere,
               d.changed_percent(),
               d.rms_steps,
               d.same() ? "same" : "DIFFERS",
               d.rms_all_steps,
               d.worst_steps});
  }
  return table;
}

Document modes_document(const Rows& rows, const Scene& scene, const Provenance& provenance) {
  Document document{.title = "Mode fast against mode plain", .name = "modes"};
  const Table table = modes_table(rows);
  document.add(Text{origin_of(provenance)}).add(Text{method_of(scene.render.ray_casting)});
  document.add(table);
  if (std::all_of(rows.begin(), rows.end(), [](const auto& row) {
        return row.depth.both_hit + row.depth.one_hit == 0;
      })) {
    document.add(Text{"No picture shows a surface: there is nothing to compare."});
  }
  document.data = {{"modes.csv", table}};
  return document;
}

Json rows_json(const Rows& rows) {
  Json list = to_json(modes_table(rows));
  for (std::size_t i = 0; i < rows.size(); ++i) list[i]["same"] = rows[i].depth.same();
  return list;
}

std::string modes_report(const Rows& rows, const Scene& scene, const Provenance& provenance) {
  Json report = report_head("modes", provenance, scene);
  report["acquisition"] = acquisition_json(scene.plan());
  report["modes"] = rows_json(rows);
  return report_text(report);
}

int compare_modes(const Arguments& arguments) {
  const Scene scene = load_scene(
      arguments.scene.file, arguments.scene.settings, "--set", render::RenderPreset::baseline);
  refuse_compared_settings(scene);
  const auto context = render::make_context(arguments.gl);
  const auto names = phantoms_of(scene);
  std::vector<PlannedStep> steps;
  for (const std::string& name : names) steps.push_back({name, name == "fetal_face" ? 3.0 : 1.0});
  const auto compare = [&](OutputFolder&, Progress& progress) -> CommandResult {
    warn_of_software(*context, arguments.gl, progress);
    warn_of_scenes(scenes_of(scene, names), progress);
    PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
    Rows rows;
    for (const std::string& name : names) {
      const Rows more = progress.step(name, [&](const PartDone& done) {
        return measure_phantom(scene, name, cache, *context, done);
      });
      rows.insert(rows.end(), more.begin(), more.end());
    }
    const Provenance provenance = provenance_of_simulation(*context, scene.simulation.seed);
    Document document = modes_document(rows, scene, provenance);
    return {.report = modes_report(rows, scene, provenance),
            .exit_code = all_same(rows) ? kDone : kFailed,
            .document = std::move(document)};
  };
  return run_in_folder(arguments.output, steps, compare);
}

}  // namespace

Command add_modes_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = add_subcommand(
      app, "modes", "Whether mode fast makes mode plain's picture, phantom by phantom");
  add_scene_options(command, arguments->scene);
  add_output_options(command, arguments->output, arguments->cache);
  add_gl_option(command, arguments->gl);
  return {&command, [arguments] { return compare_modes(*arguments); }};
}

}  // namespace wobblebench::bench
