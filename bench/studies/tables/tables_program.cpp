#include "bench/studies/tables/tables_program.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/command/common_options.h"
#include "bench/output/output_folder.h"
#include "bench/output/progress.h"
#include "bench/output/report_parts.h"
#include "bench/pipeline/outside_link.h"
#include "bench/studies/tables/measure.h"
#include "bench/studies/tables/table_options.h"
#include "bench/studies/tables/tables_report.h"
#include "bench/studies/tables/volumes.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  std::string board;
  std::string gl = "osmesa";
  OutputArguments output;
  TableArguments tables;
};

void add_options(CLI::App& app, Arguments& arguments) {
  app.add_option("--board",
                 arguments.board,
                 "Where sticks come from: file=RECORDING or xdma=DEVICE, then ,key=value …")
      ->required();
  add_gl_option(app, arguments.gl);
  add_table_options(app, arguments.tables);
  add_output_options(app, arguments.output);
}

nlohmann::ordered_json report_of(const Provenance& provenance,
                                 const TableVolumes& volumes,
                                 const TableResults& results,
                                 const TableRun& run) {
  nlohmann::ordered_json report = {{"schema", kReportSchema},
                                   {"command", "tables"},
                                   {"provenance", to_json(provenance)},
                                   {"effects", volumes.effects}};
  report["acquisition"] = acquisition_json(volumes.by_frames.at(reference_row().frames).plan());
  add_tables(report, results, run, volumes.note);
  return report;
}

int measure_recording(const Arguments& arguments) {
  const BoardArguments board = parse_outside_board(arguments.board);
  auto link = open_outside_link(board);
  const auto context = render::make_context(arguments.gl);
  OutputFolder out(arguments.output.folder);
  const TableRun run = arguments.tables.run();
  Progress progress({{"volume", 1}, {"tables", 60}});
  const TableVolumes volumes =
      progress.step("volume", [&] { return recorded_volumes(std::move(link), board.text); });
  const TableResults results = progress.step("tables", [&](const PartDone& done) {
    return measure_tables(volumes, {}, *context, run, done);
  });
  const Provenance provenance = provenance_of(*context, volumes);
  const auto report = report_of(provenance, volumes, results, run);
  const std::string markdown = to_markdown(results, run, volumes.note, provenance);
  out.write_text("tables.md", markdown);
  out.write_text("tables.csv", to_csv(results, run));
  out.write_text("report.json", report_text(report));
  out.commit();
  std::cout << (arguments.output.json ? report_text(report) : markdown);
  return 0;
}

}  // namespace

Program tables_program() {
  return {"wobblebench-tables",
          "wobblebench-tables: Tables I to IV of the paper, measured on a recording",
          [](CLI::App& app) -> std::vector<Command> {
            const auto arguments = std::make_shared<Arguments>();
            add_options(app, *arguments);
            return {{&app, [arguments] { return measure_recording(*arguments); }}};
          }};
}

}  // namespace wobblebench::bench
