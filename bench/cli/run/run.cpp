// The main job: a stream of one volume, its picture compared with the truth, written.
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "base/user_error.h"
#include "bench/cache/phantom_cache.h"
#include "bench/cli/picture/picture_limits.h"
#include "bench/cli/picture/picture_warnings.h"
#include "bench/cli/run/run_page.h"
#include "bench/cli/run/run_pictures.h"
#include "bench/cli/run/run_report.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/limits.h"
#include "bench/command/run_in_folder.h"
#include "bench/command/software_renderer.h"
#include "bench/evaluation/head_pose/find_head.h"
#include "bench/evaluation/truth/shadows.h"
#include "bench/output/encoders.h"
#include "bench/output/error_report.h"
#include "bench/output/report.h"
#include "bench/output/report_parts.h"
#include "bench/pipeline/motor_warning.h"
#include "bench/pipeline/stream/gl_stream_renderer.h"
#include "bench/pipeline/stream/program_stream_renderer.h"
#include "bench/scene/scene_cost.h"
#include "render/gl/context.h"
#include "render/gl/fetch_count.h"
#include "render/renderer.h"

namespace wobblebench::bench {

namespace {

struct RunArguments {
  SceneArguments scene;
  CacheArguments cache;
  OutputArguments output;
  std::string board = "sim";
  std::string gl = "auto";
  std::vector<std::string> limits;
  std::vector<std::string> renderers;
  std::string tolerance;  ///< empty: none
  bool frame = false;
  bool labels = false;
  bool register_surface = false;
  bool fail_on_loss = false;
  bool count_work = false;
};

/// What --tolerance asks for; nullopt: nothing.
std::optional<ToleranceRequest> tolerance_request(const RunArguments& arguments) {
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

std::vector<PlannedStep> planned_steps(const RunArguments& arguments) {
  return {{"choose", arguments.tolerance.empty() ? 0.0 : 400.0},
          {"phantom", 40},
          {"frame", arguments.frame ? 30.0 : 0.0},
          {"scene", 5},
          {"shaders", 1},
          {"stream", 25},
          {"truth", 3},
          {"compare", 5},
          {"count", arguments.count_work ? 5.0 : 0.0},
          {"labels", arguments.labels ? 3.0 : 0.0},
          {"register", arguments.register_surface ? 20.0 : 0.0},
          {"write", 2}};
}

/// nullopt: no tolerance was asked for.
std::optional<ToleranceChoice> choose_settings(std::optional<ToleranceRequest> request,
                                               const Scene& given,
                                               render::GlContext& context,
                                               PhantomCache& cache,
                                               Progress& progress) {
  if (!request) return std::nullopt;
  request->machine = machine_text(provenance_of_simulation(context, given.simulation.seed));
  return progress.step("choose", [&](const PartDone& done) {
    return choose_for_tolerance(*request, context, cache, done);
  });
}

/// The scene with the settings that keep the tolerance.
Scene with_choice(const Scene& given,
                  const RunArguments& arguments,
                  const std::optional<ToleranceChoice>& choice) {
  if (!choice) return given;
  std::vector<std::string> settings = arguments.scene.settings;
  settings.insert(settings.end(), choice->scene_settings.begin(), choice->scene_settings.end());
  Scene chosen = load_scene(arguments.scene.file, settings);
  chosen.given = given.given;  // by the user
  return chosen;
}

/// Who makes the picture: our renderer, or a program of others.
struct ChosenRenderer {
  ChosenRenderer(render::GlContext& gl, const ResolvedScene& scene) : context(gl) {
    const ProgramSetting setting = program_setting(scene.options().picture);
    if (setting.any()) {
      program = std::make_unique<ProgramRenderer>(setting);
      passes = std::make_unique<ProgramStreamRenderer>(*program, scene.plan(), scene.render());
    } else {
      renderer = std::make_unique<render::Renderer>(gl, scene.plan(), scene.render());
      passes = std::make_unique<GlStreamRenderer>(*renderer);
    }
  }

  const render::GlContext& context;
  std::unique_ptr<ProgramRenderer> program;
  std::unique_ptr<render::Renderer> renderer;
  std::unique_ptr<StreamRenderer> passes;
};

/// A volume, and the scene with the view of the head in it.
struct FramedScan {
  Acquisition acquisition;
  ResolvedScene scene;
  std::string settings;  ///< as --set takes them
};

/// Throws UserError where there is no head.
FramedScan frame_head(BoardConnection& board,
                      const SceneArguments& arguments,
                      const ResolvedScene& scene,
                      const sim::TissueMapSource& maps) {
  Acquisition acquisition = board.acquire(scene, maps);
  Scene framed = scene.options();
  SceneArguments with_view = arguments;
  std::string shown, kept;
  for (const std::string& setting :
       find_head_view(scene.plan(), acquisition.volume.frames(), "--frame")) {
    const std::string key = setting.substr(0, setting.find('='));
    if (framed.is_chosen(key)) {
      kept += (kept.empty() ? " (given, and kept: " : ", ") + key;
    } else {
      with_view.settings.push_back(setting);
      shown += (shown.empty() ? "--set '" : " --set '") + setting + "'";
    }
  }
  const render::RenderOptions viewed = load_scene(with_view.file, with_view.settings).render;
  framed.render.view = viewed.view;
  framed.render.volume_of_interest = viewed.volume_of_interest;
  return {std::move(acquisition),
          {std::move(framed), scene.subject()},
          shown + (kept.empty() ? "" : kept + ")")};
}

/// The volume, and the picture of it. `framed`: it has come already.
RunResult stream_volume(BoardConnection& board,
                        const std::optional<StreamSource>& source,
                        std::optional<FramedScan>& framed,
                        const ChosenRenderer& chosen_renderer) {
  StreamRenderer& passes = *chosen_renderer.passes;
  render::Picture picture;
  const auto show = [&](const ShownPicture& shown) { picture = shown.picture; };
  const auto show_again = [&](Acquisition taken) {
    passes.begin_volume(taken.volume.volume_index());
    for (int frame = 0; frame < taken.volume.plan().acquisition().frames_per_volume; ++frame) {
      passes.add_frame(frame, taken.volume.frame(frame));
    }
    picture = passes.render();
    return taken;
  };
  Acquisition acquisition =
      framed ? show_again(std::move(framed->acquisition)) : board.acquire(*source, passes, show);
  RunResult result(std::move(acquisition), std::move(picture));
  if (framed) result.framed = framed->settings;
  if (chosen_renderer.program) {
    result.gl_renderer =
        "the program " + chosen_renderer.program->setting().name + ", with the exchange of files";
  } else {
    result.gl_backend = chosen_renderer.context.backend();
    result.gl_renderer = chosen_renderer.context.renderer_string();
  }
  return result;
}

/// The passes of the same picture, rendered once more by shaders that count their fetches.
std::vector<render::PassTime> counted_passes(const hw::PolarVolume& volume,
                                             const ResolvedScene& scene,
                                             render::GlContext& context) {
  const render::FetchCounter counter;
  return render::render_volume(context, volume, scene.render()).passes;
}

/// No true surface, no fit and no labels.
void refuse_unknown(const RunArguments& arguments, const ResolvedScene& scene) {
  if (scene.subject()) return;
  for (const auto& [name, given] :
       {std::pair{"--register", arguments.register_surface}, {"--labels", arguments.labels}}) {
    if (!given) continue;
    throw UserError(std::string(name) + ": needs samples of a known phantom; those of --board " +
                    arguments.board + " are of an unknown subject: leave it out");
  }
}

void warn_of_picture(const RunResult& result, const ResolvedScene& scene, Progress& progress) {
  const auto& comparison = result.comparison;
  const DepthError* error = comparison ? &comparison->error.raw : nullptr;
  for (const auto& warning : picture_warnings(result.picture, scene, error)) progress.warn(warning);
}

/// What a volume shows, as far as its sticks reach.
struct TrueVolume {
  StickReach reach;
  Truth surface;
};

TrueVolume true_volume(const ResolvedScene& scene,
                       const sim::TissueMapSource& maps,
                       std::uint32_t volume) {
  StickReach reach(scene, maps, volume);
  Truth surface = true_surface(scene, scene.view(), reach, volume);
  return {std::move(reach), std::move(surface)};
}

/// The picture against the scene's truth; nullopt where that is not known.
std::optional<Comparison> compare(const RunResult& result,
                                  const ResolvedScene& scene,
                                  const sim::TissueMapSource& maps,
                                  std::future<TrueVolume> begun,
                                  const RunArguments& arguments,
                                  Progress& progress) {
  if (!begun.valid()) return std::nullopt;
  const std::uint32_t volume = result.acquisition.volume.volume_index();
  std::optional<StickReach> reach;
  TrueView truth = progress.step("truth", [&] {
    TrueVolume shown = begun.get();
    if (volume != 0) shown = true_volume(scene, maps, volume);  // of a recording
    reach = std::move(shown.reach);
    if (result.motor.matters(scene.plan())) {
      mark_outside(shown.surface, result.motor, scene.plan().geometry(), scene.view().camera);
    }
    return TrueView(std::move(shown.surface), scene.view().camera);
  });
  Image<glm::vec3> shaded;
  PictureMeasures error = progress.step("compare", [&] {
    shaded = shade_truth(truth.truth, scene.render(), result.picture.volume);
    return measure_picture(result.picture, truth, scene.render(), {}, &shaded);
  });
  Comparison comparison{.truth = std::move(truth.truth),
                        .error = std::move(error),
                        .shaded_truth = std::move(shaded)};
  if (arguments.labels) {
    comparison.labels = progress.step(
        "labels", [&] { return label_truth(scene, comparison.truth, *reach, volume); });
  }
  if (arguments.register_surface) {
    comparison.registration = progress.step("register", [&] {
      return register_surface(result.picture.depth_m,
                              *scene.subject(),
                              scene.plan(),
                              scene.view(),
                              {},
                              kRegistrationPoints,
                              volume);
    });
  }
  return comparison;
}

/// What the pictures have on disk, roughly: 6 bytes a pixel of a sphere that fills half of it.
std::uint64_t picture_bytes(const Scene& scene) {
  const auto size = static_cast<std::uint64_t>(scene.render.ray_casting.image_size);
  return 4 * size * size;
}

/// What has to hold beside the limits.
std::vector<Check> checks_of(const RunResult& result,
                             const std::optional<ToleranceResult>& tolerance,
                             const RunArguments& arguments) {
  const hw::PolarVolume& volume = result.acquisition.volume;
  const bool is_whole = result.acquisition.ending.empty();
  std::vector<Check> checks = {{.group = "run",
                                .name = "volume",
                                .failure = is_whole ? "" : ending_text(result),
                                .asked = is_whole ? "" : "--board = " + arguments.board}};
  if (tolerance) checks.push_back(tolerance_check(*tolerance));
  if (arguments.fail_on_loss) {
    checks.push_back(loss_check(static_cast<std::uint64_t>(volume.missing_sticks()),
                                static_cast<std::uint64_t>(volume.plan().sticks_per_volume()),
                                "sticks of the volume"));
  }
  return checks;
}

/// Why nothing is measured; empty: something is.
std::string why_no_measures(const RunResult& result, const ResolvedScene& scene) {
  if (!result.comparison) return "no true surface is known";
  return computes_surface(scene) ? "" : "mode \"volume\" computes no surface";
}

void warn_of_samples(const RunResult& result,
                     const BoardConnection& board,
                     const ResolvedScene& scene,
                     Progress& progress) {
  progress.warn(board.left_out());
  warn_of_motor(result.motor, scene.plan(), progress);
  warn_of_times(result.acquisition.off_plan_s, scene.plan(), scene.moves(), progress);
}

/// The only renderer of another program is the one that is meant.
RunArguments with_renderer(RunArguments arguments) {
  define_renderers(arguments.renderers);
  const Scene given = load_scene(arguments.scene.file, arguments.scene.settings);
  // A report names it, too, where it was none.
  const bool is_chosen = given.reported.contains("render.program")
                             ? !given.picture.program.empty()
                             : given.given.contains("render.program");
  if (arguments.renderers.size() == 1 && !is_chosen) {
    const std::string& only = arguments.renderers.front();
    arguments.scene.settings.push_back("render.program=" + only.substr(0, only.find('=')));
  }
  return arguments;
}

int run(const RunArguments& from_line) {
  const auto limits = parse_limits(from_line.limits, limit_names(picture_figures(nullptr, 0)));
  const RunArguments arguments = with_renderer(from_line);
  const Scene given = load_scene(arguments.scene.file, arguments.scene.settings);
  check_program(given.picture);
  refuse_unused_renderers();
  const auto request = tolerance_request(arguments);
  if (request) refuse_program(given, "run --tolerance");
  check_memory_of_run(given, available_memory_bytes());
  const BoardArguments board_arguments = parse_board(arguments.board);
  BoardConnection board(board_arguments);
  board.check_one_volume(given);
  // Context and renderer are made before the echoes: what this machine cannot render fails early.
  const auto context = render::make_context(arguments.gl);
  const auto encoders_loaded = load_encoders_early();

  const auto work = [&](OutputFolder& out, Progress& progress) {
    warn_of_software(*context, arguments.gl, progress);
    out.check_space(picture_bytes(given));
    PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
    const auto choice = choose_settings(request, given, *context, cache, progress);
    const Scene chosen = with_choice(given, arguments, choice);
    const ResolvedScene resolved = board.resolve(chosen, cache, progress);
    refuse_unknown(arguments, resolved);
    if (given.is_chosen("render.pipeline.mid_volume")) {
      progress.warn("render.pipeline.mid_volume: without effect: `run` renders a whole volume");
    }
    const sim::TissueMapSource maps = kept_maps(cache.tissue_maps());
    std::optional<FramedScan> framed;
    if (arguments.frame) {
      framed = progress.step("frame",
                             [&] { return frame_head(board, arguments.scene, resolved, maps); });
    }
    const ResolvedScene& scene = framed ? framed->scene : resolved;
    // Of the simulator's volume, beside its samples and their picture. Invalid: not known.
    std::future<TrueVolume> truth;
    if (scene.subject()) {
      truth = std::async(std::launch::async, [&] { return true_volume(scene, maps, 0); });
    }
    const ChosenRenderer chosen_renderer(*context, scene);
    std::future<void> compiled;
    if (chosen_renderer.renderer) compiled = chosen_renderer.renderer->compile_in_background();
    std::optional<StreamSource> source;
    if (!framed) {
      progress.step("scene",
                    [&] { source.emplace(board.connect(scene, maps, cache.echoes(scene))); });
    }
    if (chosen_renderer.renderer) progress.step("shaders", [&] { compiled.get(); });

    RunResult result = progress.step(
        "stream", [&] { return stream_volume(board, source, framed, chosen_renderer); });
    result.motor = hw::motor_deviation(result.acquisition.volume);
    warn_of_samples(result, board, scene, progress);
    result.comparison = compare(result, scene, maps, std::move(truth), arguments, progress);
    result.kept = cache.kept();
    warn_of_picture(result, scene, progress);
    if (arguments.count_work) {
      result.counted = progress.step(
          "count", [&] { return counted_passes(result.acquisition.volume, scene, *context); });
    }

    const auto tolerance = choice ? std::optional(tolerance_result(*choice, result)) : std::nullopt;
    const std::string summary = run_summary(result, scene, out.directory(), tolerance);
    std::future<Document> document =
        std::async(std::launch::async, [&] { return run_document(result, scene, summary); });
    progress.step("write", [&] { stage_run_images(out, result, scene); });
    CommandResult done{.report = run_report(result, scene, progress.times(), tolerance),
                       .summary = summary,
                       .failure = {},
                       .document = document.get()};
    for (Check& check : checks_of(result, tolerance, arguments)) add_check(std::move(check), done);
    const PictureMeasures* const error = result.comparison ? &result.comparison->error : nullptr;
    check_limits(
        limits,
        picture_figures(error, frame_ms(result.picture.passes), why_no_measures(result, scene)),
        done);
    return done;
  };
  return run_in_folder(arguments.output, planned_steps(arguments), work);
}

}  // namespace

Command add_run_command(CLI::App& app) {
  const auto arguments = std::make_shared<RunArguments>();
  CLI::App& command =
      add_subcommand(app, "run", "Acquire, render, compare with the truth: images, depth, report");
  add_scene_options(command, arguments->scene);
  add_output_options(command, arguments->output, arguments->cache);
  add_limit_option(command, arguments->limits, limit_names(picture_figures(nullptr, 0)));
  add_junit_option(command, arguments->output);
  add_board_option(command, arguments->board);
  add_gl_option(command, arguments->gl);
  add_renderer_option(command, arguments->renderers);
  add_flag(
      command,
      "--frame",
      arguments->frame,
      "Find the fetal head in the echoes, and set render.view and render.volume_of_interest to "
      "it, where they are not given: upright, seen from before. The settings are printed. Exit "
      "code 2 where no head is found");
  add_flag(command,
           "--labels",
           arguments->labels,
           "Write the true part of the face of each pixel, what hides it from the probe, and the "
           "landmarks (docs/labels.md): labels.exr, labels.png, landmarks.csv");
  add_flag(
      command,
      "--register",
      arguments->register_surface,
      "Fit pose, range scale and bias that lay the found surface onto the true one, which must be "
      "known (`fit` also fits the probe's errors)");
  add_text(
      command,
      "--tolerance",
      arguments->tolerance,
      "Choose the fastest settings whose P95 of depth stays within this, as 0.5mm, over pixels "
      "more than 3 mm from a silhouette (the P95 of the whole picture may be larger): measured on "
      "the scene the first time. Exit code 1 if it is not kept");
  add_flag(command,
           "--fail-on-loss",
           arguments->fail_on_loss,
           "Exit code 1 if sticks of the volume were lost; results are written all the same");
  add_flag(command,
           "--count-work",
           arguments->count_work,
           "Count the texture fetches of each pass, in a second picture");
  return {&command, [arguments] { return run(*arguments); }};
}

}  // namespace wobblebench::bench
