// Registration with its errors planted, and the detection-error model.
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/user_error.h"
#include "bench/cache/phantom_cache.h"
#include "bench/cache/watched_files.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"
#include "bench/command/software_renderer.h"
#include "bench/output/image_io.h"
#include "bench/output/report.h"
#include "bench/pipeline/scene_warnings.h"
#include "bench/scene/scene_cost.h"
#include "bench/studies/fit/fit_report.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  SceneArguments scene;
  CacheArguments cache;
  OutputArguments output;
  std::string gl = "auto";
  int seeds = 4;
  int coverage = 0;
  std::vector<std::string> judged;  ///< files of scenes
};

/// Scenes whose phantoms the model is also judged on, by the names of their files.
using JudgedScenes = std::vector<std::pair<std::string, Scene>>;

/// Of a judged scene the body and its place are taken, the rest is the fitted scene's.
void warn_of_judged(const JudgedScenes& judged, Progress& progress) {
  for (const auto& [name, scene] : judged) {
    Scene unused = scene;
    std::erase_if(unused.given, [](const std::string& key) {
      return key.starts_with("phantom.") || key.starts_with("placement.");
    });
    warn_of_unused(unused, {}, "the scene that is fitted, not --judge " + name, progress);
  }
}

JudgedScenes judged_scenes(const Arguments& arguments) {
  JudgedScenes scenes;
  for (const std::string& file : arguments.judged) {
    scenes.emplace_back(std::filesystem::path(file).stem().string(), load_scene(file, {}));
    refuse_program(scenes.back().second, "fit");
  }
  return scenes;
}

std::vector<std::filesystem::path> files_of(const Scene& scene, const JudgedScenes& judged) {
  auto files = phantom_files(scene);
  for (const auto& [name, other] : judged) {
    const auto more = phantom_files(other);
    files.insert(files.end(), more.begin(), more.end());
  }
  return files;
}

void refuse_what_is_not_fitted(const Scene& scene) {
  if (scene.moves()) throw UserError("motion: must be none; fit needs a phantom at rest");
  if (scene.render.ray_casting.mode == render::RenderMode::volume) {
    throw UserError("render.ray_casting.mode = \"volume\": must be surface or both; z is fitted");
  }
  if (scene.acquisition.volumes != 1) {
    throw UserError("acquisition.volumes = " + std::to_string(scene.acquisition.volumes) +
                    ": must be 1; fit scans one volume a seed");
  }
}

/// The scene's own picture, registered with the pose known and with nothing known.
void register_scene(const Scene& given,
                    const LoadedPhantom& phantom,
                    render::GlContext& context,
                    FitResults& results) {
  const ResolvedScene scene = fit_scene(given, phantom.phantom);
  render::Renderer renderer(context, scene.plan(), scene.render());
  const auto picture =
      render_frames(renderer, scan_with_seed(scene, scene.simulation().seed, phantom.maps));
  const SurfaceRegistration registration(scene.subject().value(), scene.plan(), scene.view());
  results.known_pose = registration.fit(picture.depth_m, RegistrationPriors::of_known_pose());
  results.nothing_known = registration.fit(picture.depth_m, RegistrationPriors::of_nothing_known());
}

/// A picture in which nothing is found has no errors to fit.
void refuse_too_few_points(const Registration& registration) {
  if (registration.points >= kLeastPoints) return;
  throw UserError("render.ray_casting: " + std::to_string(registration.points) + " of " +
                  std::to_string(registration.sampled) +
                  " found points lie near a true surface; must be at least " +
                  std::to_string(kLeastPoints) + " to fit");
}

void stage_results(OutputFolder& out, const FitResults& results) {
  for (const ResidualPicture& picture : results.model.pictures) {
    write_png(out.stage(residuals_file(picture)), residuals_picture(picture));
  }
}

FitResults measure(const Scene& scene,
                   const JudgedScenes& judged,
                   const Arguments& arguments,
                   render::GlContext& context,
                   Progress& progress) {
  PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
  warn_of_scene(scene, SampleSource::simulator, progress);
  warn_of_judged(judged, progress);
  const LoadedPhantom phantom =
      progress.step("phantom", [&] { return load_phantom(scene.phantom, cache); });
  FitResults results;
  progress.step("register", [&] { register_scene(scene, phantom, context, results); });
  refuse_too_few_points(results.known_pose);
  if (arguments.coverage > 0) {
    results.coverage = progress.step("coverage", [&](const PartDone& done) {
      return measure_coverage(scene, phantom, arguments.coverage, context, done);
    });
  }
  results.model = progress.step("model", [&](const PartDone& done) {
    return study_detection_model(scene, judged, arguments.seeds, cache, context, done);
  });
  return results;
}

int fit(const Arguments& arguments) {
  const Scene scene = load_scene(arguments.scene.file, arguments.scene.settings);
  refuse_program(scene, "fit");
  refuse_what_is_not_fitted(scene);
  const JudgedScenes judged = judged_scenes(arguments);
  check_memory_of_run(scene, available_memory_bytes());
  const auto context = render::make_context(arguments.gl);
  const std::vector<PlannedStep> steps = {
      {"phantom", 40},
      {"register", 3},
      {"coverage", 1.5 * (arguments.coverage + kReferenceSeeds)},
      {"model", 60.0 + 60.0 * arguments.seeds}};
  const auto fit_and_write = [&](OutputFolder& out, Progress& progress) -> CommandResult {
    warn_of_software(*context, arguments.gl, progress);
    WatchedFiles watched(files_of(scene, judged));
    const FitResults results = measure(scene, judged, arguments, *context, progress);
    watched.refuse_changed("fit");
    const Provenance provenance = provenance_of_simulation(*context, scene.simulation.seed);
    Json report = report_head("fit", provenance, scene);
    report["acquisition"] = acquisition_json(scene.plan());
    report["fit"] = fit_json(results);
    report["wall_ms"] = wall_json(progress.times());
    Document document = fit_document(results, provenance);
    stage_results(out, results);
    return {.report = report_text(report), .document = std::move(document)};
  };
  return run_in_folder(arguments.output, steps, fit_and_write);
}

}  // namespace

Command add_fit_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command =
      add_subcommand(app, "fit", "Register the probe's errors; fit the surface-detection error");
  add_scene_options(command, arguments->scene);
  add_output_options(command, arguments->output, arguments->cache);
  add_gl_option(command, arguments->gl);
  add_integer(
      command, "--seeds", arguments->seeds, "Seeds of each training set of the model", 1, 100);
  add_list(command,
           "--judge",
           arguments->judged,
           "Scene whose phantom the model is also judged on; may be given several times");
  add_integer(command,
              "--coverage",
              arguments->coverage,
              "Seeds with planted errors, to count how many intervals hold them; 0: none",
              0,
              1000);
  return {&command, [arguments] { return fit(*arguments); }};
}

}  // namespace wobblebench::bench
