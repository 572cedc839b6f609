// Acquisition against rendering: what limits a stream on this machine, and elsewhere.
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/user_error.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"
#include "bench/command/software_renderer.h"
#include "bench/output/report.h"
#include "bench/pipeline/scene_warnings.h"
#include "bench/scene/scene_cost.h"
#include "bench/studies/latency/latency_report.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  SceneArguments scene;
  CacheArguments cache;
  OutputArguments output;
  std::string gl = "auto";
  std::string policy = "newest";
  int volumes = 60;
  std::filesystem::path times;
};

Scene scene_of(const Arguments& arguments) {
  Scene scene = load_scene(arguments.scene.file, arguments.scene.settings);
  refuse_program(scene, "latency");
  if (scene.is_chosen("acquisition.volumes")) {
    throw UserError("acquisition.volumes: is set by --volumes; leave it out");
  }
  if (scene.render.pipeline.mid_volume) {
    throw UserError(
        "render.pipeline.mid_volume = true: must be false; pictures of whole volumes are modelled");
  }
  return scene;
}

CommandResult study_of(const Scene& scene,
                       const Arguments& arguments,
                       const std::vector<KnownTimes>& known,
                       render::GlContext& context,
                       Progress& progress) {
  const bool is_every = arguments.policy == to_string(StreamPolicy::every);
  const auto policy = is_every ? StreamPolicy::every : StreamPolicy::newest;
  PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
  const LatencyStudy study = progress.step("streams", [&](const PartDone& done) {
    return study_latency(scene, arguments.volumes, policy, known, context, cache, done);
  });
  const Provenance provenance = provenance_of_simulation(context, scene.simulation.seed);
  const Document document = latency_document(study, provenance, scene);
  Json report = report_head("latency", provenance, scene);
  report["acquisition"] = acquisition_json(scene.plan());
  report["latency"] = latency_study_json(study, document);
  report["wall_ms"] = wall_json(progress.times());
  return {.report = report_text(report), .document = document};
}

int latency(const Arguments& arguments) {
  const Scene scene = scene_of(arguments);
  std::vector<KnownTimes> known;
  if (!arguments.times.empty()) known = read_known_times(arguments.times);
  check_memory_of_run(scene, available_memory_bytes());
  const auto context = render::make_context(arguments.gl);
  return run_in_folder(
      arguments.output, {{"streams", 100}}, [&](OutputFolder&, Progress& progress) {
        warn_of_software(*context, arguments.gl, progress);
        warn_of_scene(scene, SampleSource::simulator, progress);
        return study_of(scene, arguments, known, *context, progress);
      });
}

}  // namespace

Command add_latency_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = add_subcommand(
      app, "latency", "From the echo to the picture: what limits a stream, on two clocks");
  add_scene_options(command, arguments->scene);
  add_output_options(command, arguments->output, arguments->cache);
  add_gl_option(command, arguments->gl);
  add_choice(command,
             "--policy",
             arguments->policy,
             {"newest", "every"},
             "newest: drop volumes that a later one has overtaken; every: they wait");
  add_integer(command, "--volumes", arguments->volumes, "Of each stream", 10, 1000);
  add_path(command,
           "--times",
           arguments->times,
           "report.json of tables or script/gpu: predict the scene on that machine, too");
  return {&command, [arguments] { return latency(*arguments); }};
}

}  // namespace wobblebench::bench
