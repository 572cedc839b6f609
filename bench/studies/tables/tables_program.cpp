#include "bench/studies/tables/tables_program.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"
#include "bench/command/software_renderer.h"
#include "bench/output/report_parts.h"
#include "bench/pipeline/acquisitions.h"
#include "bench/pipeline/motor_warning.h"
#include "bench/pipeline/outside_link.h"
#include "bench/studies/tables/measure.h"
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
  report["acquisition"]["motor_angles"] = motor_json(volumes.motor);
  add_tables(report, results, run, volumes.note);
  return report;
}

int measure_recording(const Arguments& arguments) {
  const BoardArguments board = parse_outside_board(arguments.board);
  auto link = open_outside_link(board);
  const auto context = render::make_context(arguments.gl);
  const TableRun run = arguments.tables.run();
  const auto measure = [&](OutputFolder&, Progress& progress) {
    progress.warn(acquisitions_warning(board));
    warn_of_software(*context, arguments.gl, progress);
    const TableVolumes volumes =
        progress.step("volume", [&] { return recorded_volumes(std::move(link), board.text); });
    warn_of_motor(volumes.motor, volumes.by_frames.at(reference_row().frames).plan(), progress);
    const TableResults results = progress.step("tables", [&](const PartDone& done) {
      return measure_tables(volumes, {}, *context, run, done);
    });
    const Provenance provenance = provenance_of(*context, volumes);
    Document document = tables_document(results, run, volumes.note, provenance);
    return CommandResult{.report = report_text(report_of(provenance, volumes, results, run)),
                         .document = std::move(document)};
  };
  return run_in_folder(arguments.output, {{"volume", 1}, {"tables", 60}}, measure);
}

}  // namespace

TableRun TableArguments::run() const {
  const int size = full ? 1 : divisor;
  // A picture of the plain pipeline takes seconds at the paper's sizes, on a CPU.
  const int plain = plain_repeats > 0 ? plain_repeats : size == 1 ? 1 : repeats;
  return {.divisor = size, .repeats = repeats, .plain_repeats = plain};
}

void add_table_options(CLI::App& command, TableArguments& arguments) {
  add_flag(command, "--full", arguments.full, "The paper's sizes; otherwise half of them a side");
  add_integer(command,
              "--divisor",
              arguments.divisor,
              "Sides are the paper's over this: 1, 2, 4 or 8",
              1,
              8)
      .check(CLI::IsMember({"1", "2", "4", "8"}))
      ->excludes("--full");
  add_repeats_option(command, arguments.repeats);
  add_integer(command,
              "--plain-repeats",
              arguments.plain_repeats,
              "Likewise, plain pipeline; default: 1 with the paper's sizes, else as --repeats",
              1,
              100)
      .default_str("");
}

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
