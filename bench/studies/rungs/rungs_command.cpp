// Speed against accuracy over the rungs of the simulator.
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "base/user_error.h"
#include "bench/cache/watched_files.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"
#include "bench/output/image_io.h"
#include "bench/output/report.h"
#include "bench/pipeline/scene_warnings.h"
#include "bench/scene/idle_options.h"
#include "bench/scene/resolved_scene.h"
#include "bench/studies/rungs/rung_comparison.h"
#include "bench/studies/rungs/rungs_report.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  SceneArguments scene;
  OutputArguments output;
  int repeats = 3;
};

void refuse_compared_settings(const Scene& scene) {
  for (const char* key : {"simulation.fidelity", "simulation.side_lobes"}) {
    if (scene.given.contains(key)) {
      throw UserError(std::string(key) + ": is set by the command itself; leave it out");
    }
  }
}

/// All rungs are compared: each must model what the options switch on.
void refuse_for_any_rung(const Scene& scene) {
  auto options = scene.simulation;
  for (const sim::Rung rung : {sim::Rung::geometry, sim::Rung::reference}) {
    options.fidelity = rung;
    try {
      sim::choose_fidelity(options, scene.plan(), scene.moves());
    } catch (const InvalidOption& error) {
      throw UserError(std::string("simulation.") + error.what());
    }
  }
}

Json report_of(const RungsResults& results,
               const Document& document,
               const Scene& scene,
               const Provenance& provenance,
               const StepTimes& times) {
  Json report = report_head("rungs", provenance, scene);
  report["acquisition"] = acquisition_json(scene.plan());
  report["rungs"] = rungs_json(results, document);
  report["wall_ms"] = wall_json(times);
  return report;
}

CommandResult measure_and_write(const Scene& scene,
                                int repeats,
                                OutputFolder& out,
                                Progress& progress) {
  const RungsResults results = measure_rungs(scene, repeats, progress);
  Provenance provenance = provenance_of_this_machine();
  provenance.board = "simulated";
  Document document = rungs_document(results, provenance);
  const std::string report =
      report_text(report_of(results, document, scene, provenance, progress.times()));
  write_png(out.stage(kFramesFile), frames_picture(results));
  return {.report = report, .document = std::move(document)};
}

/// Options that are without effect on every rung, and those that the command does not use: it
/// renders nothing, and sets the motion itself.
void warn_of_options(const Scene& given, Progress& progress) {
  std::set<std::string> used = given.given;
  std::erase_if(used, [](const std::string& key) {
    return key.starts_with("render.") || key.starts_with("motion.");
  });
  IdleInAll idle;
  Scene scene = given;
  for (const sim::Rung rung : volume_rungs()) {
    scene.simulation.fidelity = rung;
    idle.add(scene, used);
  }
  progress.warn(idle_options_text(idle.options()));
  warn_of_unused(given, {"render.", "motion."}, "run, stream and accuracy", progress);
}

int rungs(const Arguments& arguments) {
  const Scene scene = load_scene(arguments.scene.file, arguments.scene.settings);
  refuse_program(scene, "rungs");
  refuse_compared_settings(scene);
  refuse_for_any_rung(scene);
  return run_in_folder(
      arguments.output, rungs_steps(arguments.repeats), [&](OutputFolder& out, Progress& progress) {
        warn_of_options(scene, progress);
        WatchedFiles files(phantom_files(scene));
        CommandResult result = measure_and_write(scene, arguments.repeats, out, progress);
        files.refuse_changed("rungs");
        return result;
      });
}

}  // namespace

Command add_rungs_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command =
      add_subcommand(app, "rungs", "Speed against accuracy over the simulator's rungs");
  add_scene_options(command, arguments->scene);
  add_output_options(command, arguments->output);
  add_repeats_option(command, arguments->repeats);
  return {&command, [arguments] { return rungs(*arguments); }};
}

}  // namespace wobblebench::bench
