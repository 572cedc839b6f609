#include "bench/command/commands.h"

#include <CLI/CLI.hpp>
#include <utility>

#include "bench/scene/scene.h"

namespace wobblebench::bench {

std::vector<Command> add_commands(CLI::App& app) {
  app.require_subcommand(1);
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
