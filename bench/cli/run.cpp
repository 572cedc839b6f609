// The main job: a stream of one volume, its picture compared with the truth, written.
#include <iostream>
#include <memory>
#include <optional>

#include "base/user_error.h"
#include "bench/cache/kept_maps.h"
#include "bench/cache/phantom_cache.h"
#include "bench/cli/run_report.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/place_subject.h"
#include "bench/evaluation/error_model/correction.h"
#include "bench/evaluation/truth/shadows.h"
#include "bench/output/output_folder.h"
#include "bench/output/progress.h"
#include "bench/output/provenance.h"
#include "bench/pipeline/board_link.h"
#include "bench/pipeline/run_result.h"
#include "bench/pipeline/stream/gl_stream_renderer.h"
#include "bench/scene/available_memory.h"
#include "bench/scene/scene_cost.h"
#include "render/gl/context.h"
#include "render/renderer.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  SceneArguments scene;
  CacheArguments cache;
  OutputArguments output;
  std::string board = "sim";
  std::string gl = "auto";
  std::string tolerance;  ///< empty: none
  bool register_surface = false;
  bool fail_on_loss = false;
};

Truth true_surface(const phantoms::PlacedPhantom& subject,
                   const Scene& scene,
                   const sim::TissueMapSource& maps,
                   std::uint32_t volume) {
  const auto view = render::make_view(scene.render);
  Truth truth = trace_truth(subject, scene.plan(), view, volume);
  const StickReach reach(subject, scene.plan(), scene.simulation, maps, volume);
  mark_shadowed(truth, reach, view.camera);
  return truth;
}

/// The correction that the scene names, once phantom and plan are known.
std::optional<Correction> correction_of(const Scene& scene) {
  auto correction = read_correction(scene);
  if (correction) check_correction_step(*correction, scene);
  return correction;
}

/// What --tolerance asks for; none: nothing.
std::optional<ToleranceRequest> tolerance_request(const Arguments& arguments) {
  if (arguments.tolerance.empty()) return std::nullopt;
  if (!is_simulated(parse_board(arguments.board))) {
    throw UserError("--tolerance: needs --board sim: settings are chosen on the simulated scene");
  }
  ToleranceRequest request{.tolerance_mm = parse_tolerance_mm(arguments.tolerance),
                           .file = arguments.scene.file,
                           .settings = arguments.scene.settings,
                           .machine = {}};
  check_request(request);
  return request;
}

/// The scene by the settings that keep the tolerance.
Scene scene_of(const Arguments& arguments, const std::optional<ToleranceChoice>& choice) {
  std::vector<std::string> settings = arguments.scene.settings;
  if (choice) {
    settings.insert(settings.end(), choice->scene_settings.begin(), choice->scene_settings.end());
  }
  return load_scene(arguments.scene.file, settings);
}

/// The exit code, with a line on stderr unless it is 0.
int verdict(const RunResult& result,
            const std::optional<ToleranceResult>& tolerance,
            const Arguments& arguments) {
  if (!result.acquisition.ending.empty()) {
    std::cerr << "wobblebench: --board = " << arguments.board << ": " << ending_text(result)
              << "\n";
    return 1;
  }
  if (const std::string why = tolerance ? broken_promise(*tolerance) : ""; !why.empty()) {
    std::cerr << "wobblebench: " << why << "\n";
    return 1;
  }
  if (!arguments.fail_on_loss || result.acquisition.volume.missing_sticks() == 0) return 0;
  std::cerr << "wobblebench: --fail-on-loss: " << loss_text(result) << "\n";
  return 1;
}

int run(const Arguments& arguments) {
  Scene scene = scene_of(arguments, std::nullopt);
  auto request = tolerance_request(arguments);
  check_memory_of_run(scene, available_memory_bytes());
  read_correction(scene);  // refuses one that was made for something else before any work
  BoardConnection board(parse_board(arguments.board));
  board.check_one_volume(scene);
  // Context and renderer are made before the echoes: what this machine cannot render fails early.
  const auto context = render::make_context(arguments.gl);
  OutputFolder out(arguments.output.folder);
  Progress progress({{"choose", request ? 400.0 : 0.0},
                     {"phantom", 40},
                     {"scene", 5},
                     {"shaders", 1},
                     {"stream", 25},
                     {"truth", 3},
                     {"compare", 5},
                     {"register", arguments.register_surface ? 20.0 : 0.0},
                     {"write", 2}});

  PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
  std::optional<ToleranceChoice> choice;
  if (request) {
    request->machine = machine_text(provenance_of_simulation(*context, scene.simulation.seed));
    choice = progress.step("choose", [&](const PartDone& done) {
      return choose_for_tolerance(*request, *context, cache, done);
    });
    scene = scene_of(arguments, choice);
  }
  const auto subject = place_subject(scene, board.adopt_plan(scene), cache, progress);
  const auto correction = correction_of(scene);
  const auto plan = scene.plan();
  const auto view = render::make_view(scene.render);
  render::Renderer renderer(*context, plan, scene.render);
  auto compiled = renderer.compile_in_background();

  const sim::TissueMapSource maps = kept_maps(cache.tissue_maps());
  const StreamSource source = progress.step("scene", [&] {
    return subject ? board.connect(scene, *subject, maps) : board.connect(scene);
  });
  progress.step("shaders", [&] { compiled.get(); });
  GlStreamRenderer passes(renderer);
  render::Picture picture;
  auto acquisition = progress.step("stream", [&] {
    return board.acquire(
        source, passes, [&](const ShownPicture& shown) { picture = shown.picture; });
  });
  std::optional<render::Picture> uncorrected;
  if (correction) {
    uncorrected = picture;
    picture = progress.step("correct", [&] {
      return corrected_picture(*correction, renderer, picture, acquisition.volume, scene);
    });
  }
  RunResult result{std::move(acquisition),
                   std::move(picture),
                   context->backend(),
                   context->renderer_string(),
                   std::nullopt,
                   cache.kept()};

  if (subject) {
    const std::uint32_t volume = result.acquisition.volume.volume_index();
    TrueView truth = progress.step("truth", [&] {
      return TrueView(true_surface(*subject, scene, maps, volume), view.camera);
    });
    auto error = progress.step(
        "compare", [&] { return measure_picture(result.picture, truth, scene.render); });
    std::optional<PictureMeasures> before;
    if (uncorrected) before = measure_picture(*uncorrected, truth, scene.render);
    result.comparison = {std::move(truth.truth), std::move(error), std::nullopt, std::move(before)};
    if (arguments.register_surface) {
      result.comparison->registration = progress.step("register", [&] {
        return register_surface(
            result.picture.depth_m, *subject, plan, view, {}, kRegistrationPoints, volume);
      });
    }
  }

  std::optional<ToleranceResult> tolerance;
  if (choice) tolerance = tolerance_result(*choice, result);
  progress.step("write", [&] { stage_run_images(out, result); });
  const std::string report = run_report(result, scene, progress.times(), tolerance);
  out.write_text("report.json", report);
  out.commit();
  std::cout << (arguments.output.json ? report
                                      : run_summary(result, scene, out.directory(), tolerance));
  return verdict(result, tolerance, arguments);
}

}  // namespace

Command add_run_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command =
      add_subcommand(app, "run", "Acquire, render, compare with the truth: images, depth, report");
  add_scene_options(command, arguments->scene);
  add_cache_options(command, arguments->cache);
  add_output_options(command, arguments->output);
  add_board_option(command, arguments->board);
  add_gl_option(command, arguments->gl);
  add_flag(
      command,
      "--register",
      arguments->register_surface,
      "Fit pose, range scale and bias that lay the found surface onto the true one (`fit` also "
      "fits the probe's errors)");
  add_text(
      command,
      "--tolerance",
      arguments->tolerance,
      "Choose the fastest settings whose P95 of depth stays within this, as 0.5mm: measured on "
      "the scene the first time. Exit code 1 if it is not kept");
  add_flag(command,
           "--fail-on-loss",
           arguments->fail_on_loss,
           "Exit code 1 if sticks of the volume were lost; results are written all the same");
  return {&command, [arguments] { return run(*arguments); }};
}

}  // namespace wobblebench::bench
