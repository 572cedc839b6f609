// The commands of the program: one .cpp file each, which declares its own options.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace wobblebench::bench {

/// A subcommand. Parsing fills in its options; `run` then executes it and returns the exit code.
/// Errors in the user's input are thrown as UserError.
struct Command {
  CLI::App* subcommand;
  std::function<int()> run;
};

/// Each adds its subcommand with its options to `app`.
Command add_run_command(CLI::App& app);
Command add_record_command(CLI::App& app);
Command add_inspect_command(CLI::App& app);
Command add_conformance_command(CLI::App& app);
Command add_rehearse_command(CLI::App& app);
Command add_board_command(CLI::App& app);
Command add_stand_in_command(CLI::App& app);
Command add_phantom_command(CLI::App& app);
Command add_tables_command(CLI::App& app);
Command add_modes_command(CLI::App& app);
Command add_validate_command(CLI::App& app);
Command add_trade_command(CLI::App& app);

}  // namespace wobblebench::bench
