// The main job: acquire, render, compare with the truth, write.
#include <iostream>
#include <memory>

#include "bench/cli/commands.h"
#include "bench/cli/common_options.h"
#include "bench/pipeline/run_result.h"
#include "bench/report/output_folder.h"
#include "bench/report/progress.h"
#include "bench/report/run_report.h"
#include "render/gl/context.h"
#include "render/renderer.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  SceneArguments scene;
  OutputArguments output;
  std::string board = "sim";
  std::string gl = "osmesa";
};

render::Picture render_volume(render::Renderer& renderer, const hw::PolarVolume& volume) {
  renderer.add_volume(volume);
  return renderer.render();
}

int run(const Arguments& arguments) {
  Scene scene = load_scene(arguments.scene.file, arguments.scene.settings);
  BoardConnection board(parse_board(arguments.board));
  // Context and renderer are made before the echoes: what this machine cannot render fails early.
  const auto context = render::make_context(arguments.gl);
  OutputFolder out(arguments.output.folder);
  Progress progress({{"phantom", 40},
                     {"acquire", 25},
                     {"render", 5},
                     {"truth", 3},
                     {"compare", 5},
                     {"register", 20},
                     {"write", 2}});

  board.adopt_plan(scene);
  const auto phantom = progress.step("phantom", [&] { return make_phantom(scene.phantom); });
  complete_from_phantom(scene, phantom);
  const auto subject = scene.place(phantom);
  const auto plan = scene.plan();
  const auto view = render::make_view(scene.render);
  render::Renderer renderer(*context, plan, scene.render);

  auto acquisition = progress.step("acquire", [&] { return board.acquire(scene, subject); });
  auto picture =
      progress.step("render", [&] { return render_volume(renderer, acquisition.volume); });
  RunResult result{std::move(acquisition),
                   std::move(picture),
                   context->backend(),
                   context->renderer_string(),
                   std::nullopt};

  if (result.acquisition.source == hw::StreamOrigin::simulated) {
    auto truth = progress.step("truth", [&] { return trace_truth(subject, plan, view); });
    auto error = progress.step(
        "compare", [&] { return measure_picture_error(result.picture, truth, scene.render); });
    const auto registration = progress.step(
        "register", [&] { return register_surface(result.picture.depth_m, subject, plan, view); });
    result.comparison = {std::move(truth), std::move(error), registration};
  }

  progress.step("write", [&] { stage_run_images(out, result); });
  const std::string report = run_report(result, scene, progress.times());
  out.write_text("report.json", report);
  out.commit();
  std::cout << (arguments.output.json ? report : run_summary(result, scene, out.directory()));
  if (result.acquisition.ending.empty()) return 0;
  std::cerr << "wobblebench: --board = " << arguments.board << ": " << ending_text(result) << "\n";
  return 1;
}

}  // namespace

Command add_run_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command =
      add_subcommand(app, "run", "Acquire, render, compare with the truth: images, depth, report");
  add_scene_options(command, arguments->scene);
  add_output_options(command, arguments->output);
  add_board_option(command, arguments->board);
  add_gl_option(command, arguments->gl);
  return {&command, [arguments] { return run(*arguments); }};
}

}  // namespace wobblebench::bench
