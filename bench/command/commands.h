// The commands of wobblebench: one .cpp file each, which declares its own options.
#pragma once

#include <vector>

#include "bench/command/program.h"

namespace wobblebench::bench {

/// All of them, in the order of --help.
std::vector<Command> add_commands(CLI::App& app);
/// What main() runs.
Program wobblebench_program();

/// Each adds its subcommand with its options to `app`.
Command add_run_command(CLI::App& app);
Command add_compare_command(CLI::App& app);
Command add_score_command(CLI::App& app);
Command add_stream_command(CLI::App& app);
Command add_live_command(CLI::App& app);
Command add_latency_command(CLI::App& app);
Command add_record_command(CLI::App& app);
Command add_inspect_command(CLI::App& app);
Command add_export_command(CLI::App& app);
Command add_conformance_command(CLI::App& app);
Command add_rehearse_command(CLI::App& app);
Command add_board_command(CLI::App& app);
Command add_stand_in_command(CLI::App& app);
Command add_phantom_command(CLI::App& app);
Command add_tables_command(CLI::App& app);
Command add_rungs_command(CLI::App& app);
Command add_trade_command(CLI::App& app);
Command add_tune_command(CLI::App& app);
Command add_dataset_command(CLI::App& app);
Command add_accuracy_command(CLI::App& app);
Command add_fit_command(CLI::App& app);
Command add_extremes_command(CLI::App& app);

}  // namespace wobblebench::bench
