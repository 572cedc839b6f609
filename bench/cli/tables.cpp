// Tables I to IV of the paper, measured.
#include <iostream>

#include "bench/cli/commands.h"
#include "bench/cli/progress.h"
#include "bench/pipeline/board_link.h"
#include "bench/report/image_io.h"
#include "bench/report/output_folder.h"
#include "bench/report/report.h"
#include "bench/scene/adopt_plan.h"
#include "bench/tables/measure.h"
#include "bench/tables/table_scans.h"
#include "bench/tables/tables_figure.h"
#include "bench/tables/tables_report.h"

namespace wobblebench::bench {

namespace {

TableVolumes simulate(Scene& scene, const BoardArguments& board, Progress& progress) {
  const auto phantom =
      progress.step("phantom", [&] { return phantoms::make_phantom(scene.phantom); });
  complete_from_phantom(scene, phantom);
  return progress.step("scans", [&] { return scan_table_volumes(scene, phantom, board); });
}

TableVolumes play(Scene& scene, const BoardArguments& board, Progress& progress) {
  auto volumes = progress.step(
      "volume", [&] { return recorded_volumes(open_outside_link(board), board.text); });
  adopt_plan(scene, volumes.by_frames.at(reference_row().frames).plan(), "--board " + board.text);
  return volumes;
}

Json to_report(const TableVolumes& volumes,
               const TableResults& results,
               const TableRun& run,
               const Provenance& provenance,
               const Scene& scene) {
  Json report = report_head("tables", provenance, scene);
  report["effects"] = volumes.effects;
  report["acquisition"] = acquisition_json(scene.plan());
  add_tables(report, results, run, volumes.note);
  return report;
}

}  // namespace

int tables_command(const CommandArguments& arguments) {
  Scene scene = load_scene(arguments.scene, arguments.settings);
  const TableRun run = arguments.tables.run();
  const BoardArguments board = parse_board(arguments.board);
  take_reference_settings(scene, run);
  // Before any echo is made: a machine without this GL says so now.
  const auto context = render::make_context(arguments.gl);
  OutputFolder out(arguments.out);
  Progress progress;
  const TableVolumes volumes =
      is_simulated(board) ? simulate(scene, board, progress) : play(scene, board, progress);
  const TableResults results =
      progress.step("tables", [&] { return measure_tables(volumes, scene.render, *context, run); });

  Provenance provenance = provenance_of_this_machine();
  provenance.gl_backend = context->backend();
  provenance.gl_renderer = context->renderer_string();
  provenance.board = volumes.board;
  provenance.seed = scene.simulation.seed;
  const Json report = to_report(volumes, results, run, provenance, scene);
  const std::string page = to_markdown(results, run, volumes.note, provenance);
  out.write_text("tables.md", page);
  out.write_text("tables.csv", to_csv(results, run));
  write_png(out.stage("tables.png"), draw_tables(results));
  out.write_text("report.json", report.dump(2) + "\n");
  out.commit();
  std::cout << (arguments.json ? report.dump(2) + "\n" : page);
  return 0;
}

}  // namespace wobblebench::bench
