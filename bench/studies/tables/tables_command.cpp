// Tables I to IV of the paper, measured.
#include "bench/studies/tables/tables_command.h"

#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/user_error.h"
#include "bench/cache/phantom_cache.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"
#include "bench/command/software_renderer.h"
#include "bench/output/report.h"
#include "bench/pipeline/acquire.h"
#include "bench/pipeline/acquisitions.h"
#include "bench/pipeline/board_link.h"
#include "bench/pipeline/motor_warning.h"
#include "bench/pipeline/scene_warnings.h"
#include "bench/scene/resolved_scene.h"
#include "bench/studies/tables/measure.h"
#include "bench/studies/tables/tables_program.h"
#include "bench/studies/tables/tables_report.h"

namespace wobblebench::bench {

namespace {

struct TablesArguments {
  SceneArguments scene;
  CacheArguments cache;
  OutputArguments output;
  std::string board = "sim";
  std::string gl = "auto";
  TableArguments tables;
};

TableVolumes simulate(Scene& scene,
                      const BoardArguments& board,
                      PhantomCache cache,
                      Progress& progress) {
  const auto phantom = progress.step("phantom", [&] { return cache.phantom(scene.phantom); });
  scene = resolve_scene(scene, phantom).options();
  return progress.step("scans", [&](const PartDone& done) {
    return scan_table_volumes(scene, phantom, board, cache.tissue_maps(), done);
  });
}

TableVolumes play(Scene& scene,
                  const BoardArguments& board,
                  std::unique_ptr<hw::Link> link,
                  Progress& progress) {
  auto volumes =
      progress.step("volume", [&] { return recorded_volumes(std::move(link), board.text); });
  const auto& plan = volumes.by_frames.at(reference_row().frames).plan();
  scene = with_plan(scene, plan, "--board " + board.text);
  warn_of_motor(volumes.motor, plan, progress);
  return volumes;
}

Json tables_report(const TableVolumes& volumes,
                   const TableResults& results,
                   const TableRun& run,
                   const Provenance& provenance,
                   const Scene& scene,
                   const Document& document) {
  Json report = report_head("tables", provenance, scene);
  report["effects"] = volumes.effects;
  report["acquisition"] = acquisition_json(scene.plan(), volumes.knows_times);
  if (volumes.motor.sticks > 0) {
    report["acquisition"]["motor_angles"] = motor_json(volumes.motor);
  }
  add_tables(report, results, run, volumes.note, document);
  return report;
}

/// The tables compare no picture with a truth: of a recording's scene they take the renderer's
/// settings alone.
void warn_of_options(Scene scene, bool is_simulated, Progress& progress) {
  if (is_simulated) return warn_of_scene(scene, SampleSource::simulator, progress);
  warn_of_unused(
      scene, {"phantom.", "placement.", "motion.", "simulation."}, "--board sim", progress);
  std::erase_if(scene.given, [](const std::string& key) { return !key.starts_with("render."); });
  warn_of_scene(scene, SampleSource::unknown_subject, progress);
}

CommandResult measure_and_write(Scene scene,
                                const TablesArguments& arguments,
                                const BoardArguments& board,
                                std::unique_ptr<hw::Link> link,
                                render::GlContext& context,
                                Progress& progress) {
  const TableRun run = arguments.tables.run();
  const TableVolumes volumes =
      link ? play(scene, board, std::move(link), progress)
           : simulate(scene, board, open_phantom_cache(arguments.cache.most_megabytes()), progress);
  const TableResults results = progress.step("tables", [&](const PartDone& done) {
    return measure_tables(volumes, scene.render, context, run, done);
  });
  Provenance provenance = provenance_of(context, volumes);
  provenance.seed = scene.simulation.seed;
  Document document = tables_document(results, run, volumes.note, provenance);
  const std::string report =
      report_text(tables_report(volumes, results, run, provenance, scene, document));
  return {.report = report, .document = std::move(document)};
}

int measure(const TablesArguments& arguments) {
  Scene scene = load_scene(
      arguments.scene.file, arguments.scene.settings, "--set", render::RenderPreset::baseline);
  const BoardArguments board = parse_board(arguments.board);
  refuse_program(scene, "tables");
  take_reference_settings(scene, arguments.tables.run());
  // Made before the echoes: where this machine lacks the GL, the command fails early.
  const auto context = render::make_context(arguments.gl);
  auto link = is_simulated(board) ? nullptr : open_recorded_link(board);
  return run_in_folder(arguments.output,
                       {{"phantom", 4}, {"scans", 14}, {"volume", 1}, {"tables", 80}},
                       [&](OutputFolder&, Progress& progress) {
                         progress.warn(acquisitions_warning(board));
                         warn_of_software(*context, arguments.gl, progress);
                         warn_of_options(scene, is_simulated(board), progress);
                         return measure_and_write(
                             scene, arguments, board, std::move(link), *context, progress);
                       });
}

}  // namespace

void take_reference_settings(Scene& scene, const TableRun& run) {
  for (const char* key : {"acquisition.frames_per_volume",
                          "render.pipeline.mode",
                          "render.scan_conversion.slice_size",
                          "render.ray_casting.image_size",
                          "render.ray_casting.steps",
                          "render.ray_casting.kernel_3d",
                          "render.ray_casting.kernel_space",
                          "render.ray_casting.mode",
                          "render.shading.base",
                          "render.shading.depth_filter_size",
                          "render.smoothing.filter_size"}) {
    if (scene.is_chosen(key)) {
      throw UserError(std::string(key) + ": is set by the tables themselves; leave it out");
    }
  }
  scene.acquisition.frames_per_volume = reference_row().frames;
  scene.render = settings_of(reference_row(), scene.render, run.divisor);
}

TableVolumes scan_table_volumes(const Scene& scene,
                                const phantoms::Phantom& phantom,
                                const BoardArguments& board,
                                const sim::TissueMapSource& maps,
                                const PartDone& done) {
  TableVolumes volumes;
  PartCount parts(frame_counts().size(), done);
  for (const int frames : frame_counts()) {
    Scene varied = scene;
    varied.acquisition.frames_per_volume = frames;
    Acquisition acquisition = BoardConnection(board).acquire(resolve_scene(varied, phantom), maps);
    volumes.board = hw::to_string(acquisition.link.origin);
    volumes.effects = acquisition.simulated.value().effects;
    volumes.by_frames.emplace(frames, std::move(acquisition.volume));
    parts.finish_one();
  }
  return volumes;
}

Command add_tables_command(CLI::App& app) {
  const auto arguments = std::make_shared<TablesArguments>();
  CLI::App& command = add_subcommand(app, "tables", "Tables I to IV beside the paper's");
  add_scene_options(command, arguments->scene);
  add_output_options(command, arguments->output, arguments->cache);
  add_board_option(command, arguments->board);
  add_gl_option(command, arguments->gl);
  add_table_options(command, arguments->tables);
  return {&command, [arguments] { return measure(*arguments); }};
}

}  // namespace wobblebench::bench
