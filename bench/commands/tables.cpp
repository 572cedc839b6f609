// Tables I to IV of the paper, measured.
#include "bench/tables.h"

#include <iostream>

#include "bench/commands/commands.h"
#include "bench/output_folder.h"
#include "bench/progress.h"
#include "bench/report.h"

namespace wobblebench::bench {

namespace {

Json rows_json(const MeasuredTable& table, const std::vector<std::string>& pass_names) {
  Json rows = Json::array();
  for (const MeasuredRow& row : table.rows) {
    Json passes = Json::array();
    for (std::size_t i = 0; i < pass_names.size(); ++i) {
      passes.push_back({{"name", pass_names[i]}, {"ms", row.pass_ms[i]}});
    }
    rows.push_back({{"setting", row.row.setting},
                    {"paper_ms", row.row.paper_ms},
                    {"plain_ms", row.frame_ms.median},
                    {"plain_min_ms", row.frame_ms.min},
                    {"plain_max_ms", row.frame_ms.max},
                    {"paper_ratio", row.paper_ratio},
                    {"plain_ratio", row.ratio},
                    {"passes", passes}});
  }
  return rows;
}

}  // namespace

int tables_command(const CommandArguments& arguments) {
  Scene scene = load_scene(arguments.scene, arguments.settings);
  const TableRun run{arguments.full ? 1 : 2, arguments.repeats};
  take_reference_settings(scene, run);
  OutputFolder out(arguments.out);
  Progress progress;
  const auto phantom =
      progress.step("phantom", [&] { return phantoms::make_phantom(scene.phantom); });
  complete_from_phantom(scene, phantom);
  const auto context = render::make_context();
  const TableResults results =
      progress.step("tables", [&] { return measure_tables(scene, phantom, *context, run); });

  Provenance provenance = provenance_of_this_machine();
  provenance.gl_renderer = context->renderer_string();
  provenance.board = results.board;
  Json report = report_head("tables", provenance, scene);
  report["effects"] = results.effects;
  report["run"] = describe_run(run);
  report["reference"] = {{"setting", results.reference.row.setting},
                         {"paper_ms", results.reference.row.paper_ms},
                         {"plain_ms", results.reference.frame_ms.median}};
  report["tables"] = Json::array();
  for (const MeasuredTable& table : results.tables) {
    report["tables"].push_back(
        {{"id", table.id}, {"title", table.title}, {"rows", rows_json(table, results.pass_names)}});
  }
  const std::string markdown =
      "CPU: " + provenance.cpu + ", " + std::to_string(provenance.threads) +
      " threads. GL_RENDERER: " + provenance.gl_renderer + ". Commit: " + provenance.commit +
      ". Seed: " + std::to_string(scene.simulation.seed) + ". Sticks: " + results.board + ".\n\n" +
      to_markdown(results, run);
  out.write_text("tables.md", markdown);
  out.write_text("tables.csv", to_csv(results, run));
  out.write_text("report.json", report.dump(2) + "\n");
  out.commit();
  std::cout << (arguments.json ? report.dump(2) + "\n" : markdown);
  return 0;
}

}  // namespace wobblebench::bench
