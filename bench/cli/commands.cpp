#include "bench/command/commands.h"

#include <CLI/CLI.hpp>
#include <utility>

#include "bench/cli/report_schema.h"
#include "bench/evaluation/measures/picture_measures.h"
#include "bench/output/document/table.h"
#include "bench/results/counts.h"
#include "bench/results/times.h"
#include "bench/scene/scene.h"

namespace wobblebench::bench {

namespace {

/// docs/measures.md has it.
std::string measures_text() {
  using M = const Measure*;
  const auto section = [](const char* caption, Chosen measures) {
    return markdown(table_of<M>({.caption = caption},
                                measures,
                                {{{"figure"}, [](M of) { return Cell::code(of->key); }},
                                 {{"name"}, [](M of) { return of->title; }},
                                 {{"unit"}, [](M of) { return unit_of(of->key).name; }},
                                 {{"what"}, [](M of) { return of->help; }}}));
  };
  std::string text =
      section(
          "# Measures\n\nWhat is measured of a picture against the truth, by the names of "
          "`--limit`.",
          picture_measures()) +
      section(
          "\n## Times\n\n`stream` has `p50_ms` to `n` of `age_oldest`, `age_newest`, "
          "`ready_to_written` and `interval`, between pictures: `age_oldest_p99_ms`.",
          times::kAll) +
      section("\n## Counts", counts::kAll);
  text.pop_back();  // CLI11 ends it with a line of its own
  return text;
}

}  // namespace

std::vector<Command> add_commands(CLI::App& app) {
  app.require_subcommand(1);
  const auto print = [&app](const char* flag, const char* help, const auto& text) {
    const auto show = [text] { throw CLI::CallForVersion(text(), CLI::ExitCodes::Success); };
    app.add_flag_callback(flag, show, help)->trigger_on_parse();
  };
  print("--measures", "Print the figures, and what they are", measures_text);
  print("--report-schema", "Print the JSON Schema of report.json", [&app] {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
    return report_schema(names);
  });
  std::vector<Command> commands = {
      add_run_command(app),         add_score_command(app),    add_compare_command(app),
      add_stream_command(app),      add_live_command(app),     add_latency_command(app),
      add_record_command(app),      add_inspect_command(app),  add_export_command(app),
      add_conformance_command(app), add_rehearse_command(app), add_board_command(app),
      add_stand_in_command(app),    add_phantom_command(app),  add_tables_command(app),
      add_rungs_command(app),       add_trade_command(app),    add_tune_command(app),
      add_accuracy_command(app),    add_fit_command(app),      add_extremes_command(app),
      add_dataset_command(app)};
  for (Command& command : commands) {
    command.run = [run = std::move(command.run)] { return with_late_refusals(run); };
  }
  return commands;
}

Program wobblebench_program() {
  return {
      "wobblebench", "wobblebench: a test bench for 4D ultrasound surface rendering", add_commands};
}

}  // namespace wobblebench::bench
