// Every measure of the picture against the truth, over scenes, rungs, render settings and seeds.
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "bench/cache/phantom_cache.h"
#include "bench/cache/watched_files.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"
#include "bench/command/software_renderer.h"
#include "bench/evaluation/seed_statistics.h"
#include "bench/exchange/program/renderer_process.h"
#include "bench/output/image_io.h"
#include "bench/output/report.h"
#include "bench/pipeline/scene_warnings.h"
#include "bench/scene/idle_options.h"
#include "bench/scene/scene_cost.h"
#include "bench/studies/accuracy/accuracy_plan.h"
#include "bench/studies/accuracy/accuracy_report.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  const CLI::App* command = nullptr;
  SceneArguments plan;
  CacheArguments cache;
  OutputArguments output;
  std::filesystem::path settings;
  int seeds = 0;  ///< 0: the plan's
  std::string gl = "auto";
  std::vector<std::string> renderers;
};

AccuracyPlan plan_of(const Arguments& arguments) {
  const auto& file = arguments.plan.file;
  AccuracyPlan plan = !file.empty() && is_accuracy_plan(file)
                          ? load_accuracy_plan(file)
                          : accuracy_plan_of_scene(file, arguments.plan.settings);
  if (!arguments.settings.empty())
    plan.settings = load_option_tables(arguments.settings, "settings");
  if (arguments.seeds > 0 && !plan.drawn.empty()) {
    throw UserError("--seeds: the population draws a seed for each scene; leave it out");
  }
  if (arguments.seeds > 0) plan.seeds = seeds_from(plan.seeds.front(), arguments.seeds);
  return plan;
}

/// One setting of a scene on each rung of the plan; all rungs are checked.
AccuracyScene::Setting setting_of(const AccuracyPlan& plan,
                                  const NamedOptions& scene,
                                  const NamedOptions& setting,
                                  const std::vector<std::string>& more) {
  AccuracyScene::Setting read;
  read.name = setting.name;
  std::vector<std::string> settings = scene.settings;
  settings.insert(settings.end(), setting.settings.begin(), setting.settings.end());
  settings.insert(settings.end(), more.begin(), more.end());
  read.command = run_command_line(scene.file, settings);
  for (const sim::Rung rung : plan.rungs) {
    read.scene = planned_scene(plan, scene, setting, rung, more);
    check_program(read.scene.picture);
    check_memory_of_run(read.scene, available_memory_bytes());
  }
  return read;
}

/// Reads and checks everything that the plan names, before any work.
std::vector<AccuracyScene> scenes_of(const AccuracyPlan& plan,
                                     const std::vector<std::string>& more) {
  std::vector<AccuracyScene> scenes(plan.scenes.size());
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    scenes[i].drawn = !plan.drawn.empty();
    scenes[i].name = scenes[i].drawn ? plan.drawn[i].stratum : plan.scenes[i].name;
    scenes[i].rungs = plan.rungs;
    scenes[i].seeds = scenes[i].drawn ? std::vector{plan.drawn[i].seed} : plan.seeds;
    for (const NamedOptions& setting : plan.settings) {
      scenes[i].settings.push_back(setting_of(plan, plan.scenes[i], setting, more));
    }
  }
  refuse_unused_renderers();
  return scenes;
}

Json report_of(const AccuracyResults& results,
               const std::vector<AccuracyScene>& scenes,
               const Provenance& provenance,
               const StepTimes& times) {
  Json report = report_head("accuracy", provenance, scenes.front().settings.front().scene);
  report["scene"] = nullptr;  // there are several
  report["scenes"] = Json::object();
  for (const AccuracyScene& scene : scenes) {
    for (const auto& setting : scene.settings) {
      const std::string key =
          scene.drawn ? scene.name + "-" + std::to_string(scene.seeds.front()) : scene.name;
      report["scenes"][key][setting.name] = scene_json(setting.scene);
    }
  }
  report["accuracy"] = accuracy_json(results);
  report["wall_ms"] = wall_json(times);
  return report;
}

/// Every scene with every setting on every rung.
std::vector<Scene> all_scenes(const std::vector<AccuracyScene>& scenes) {
  std::vector<Scene> all;
  for (const AccuracyScene& scene : scenes) {
    for (const auto& setting : scene.settings) {
      for (const sim::Rung rung : scene.rungs) {
        all.push_back(setting.scene);
        all.back().simulation.fidelity = rung;
      }
    }
  }
  return all;
}

void warn_of_options(const std::vector<Scene>& scenes,
                     const Arguments& arguments,
                     Progress& progress) {
  const std::string key = "simulation.seed";
  IdleInAll seed;
  for (const Scene& scene : scenes) seed.add(scene, {key});
  const auto idle = seed.options();
  warn_of_scenes(scenes, progress);
  if (idle.empty()) return;
  progress.warn(
      idle_options_text(*arguments.command, {{"--seeds", false, idle.front().acts_with}}));
}

/// Files that are read while pictures are measured.
std::vector<std::filesystem::path> files_of(const std::vector<Scene>& scenes) {
  std::vector<std::filesystem::path> files;
  for (const Scene& scene : scenes) {
    for (const auto& file : phantom_files(scene)) {
      if (std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
    }
  }
  return files;
}

CommandResult measure_and_write(const std::vector<AccuracyScene>& scenes,
                                const Arguments& arguments,
                                render::GlContext& context,
                                OutputFolder& out,
                                Progress& progress) {
  PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
  const std::vector<Scene> all = all_scenes(scenes);
  warn_of_options(all, arguments, progress);
  WatchedFiles files(files_of(all));
  const AccuracyResults results = progress.step("measure", [&](const PartDone& done) {
    return measure_accuracy(scenes, context, cache, done, [&](const std::string& what) {
      progress.note(what);
      files.refuse_changed("accuracy");
    });
  });
  files.refuse_changed("accuracy");
  const Provenance provenance = provenance_of_simulation(context, results.seeds.front());
  progress.step("write", [&] {
    write_png(out.stage(kAccuracySheet), accuracy_sheet(results));
    for (const AccuracyPicture& picture : results.pictures) {
      write_png(out.stage(accuracy_picture_file(picture)), picture.surface, Values::light);
    }
  });
  const Document document = accuracy_document(results, provenance);
  return {.report = report_text(report_of(results, scenes, provenance, progress.times())),
          .document = document};
}

int accuracy(const Arguments& arguments) {
  const AccuracyPlan plan = plan_of(arguments);
  const auto scenes = scenes_of(plan, arguments.plan.settings);
  const auto context = render::make_context(arguments.gl);
  return run_in_folder(arguments.output,
                       {{"measure", 95}, {"write", 5}},
                       [&](OutputFolder& out, Progress& progress) {
                         warn_of_software(*context, arguments.gl, progress);
                         return measure_and_write(scenes, arguments, *context, out, progress);
                       });
}

}  // namespace

Command add_accuracy_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command =
      add_subcommand(app,
                     "accuracy",
                     "Every measure of the picture against the truth, over seeds, with intervals");
  arguments->command = &command;
  add_plan_options(command, arguments->plan);
  add_path(
      command,
      "--settings",
      arguments->settings,
      "TOML file with the render settings to compare, [settings.NAME.render…], in place of the "
      "plan's");
  add_integer(
      command, "--seeds", arguments->seeds, "Number of seeds; 0: the plan's, or 10", 0, kMostSeeds);
  add_output_options(command, arguments->output, arguments->cache);
  add_gl_option(command, arguments->gl);
  add_renderer_option(command, arguments->renderers);
  return {&command, [arguments] {
            define_renderers(arguments->renderers);
            return accuracy(*arguments);
          }};
}

}  // namespace wobblebench::bench
