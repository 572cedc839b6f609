// The path from probe to volume under seeded faults, in virtual time.
#include <cstdint>
#include <iostream>
#include <memory>

#include "bench/board_checks/fault_simulation/seed_range.h"
#include "bench/cli/fault_simulation_report.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  OutputArguments output;
  int seeds = 1000;
  std::uint64_t first_seed = 1;
  bool trace = false;
};

void print_trace(std::uint64_t first_seed, int seeds) {
  for (int i = 0; i < seeds; ++i) {
    simulate_faults(first_seed + static_cast<std::uint64_t>(i),
                    [](const std::string& line) { std::cerr << line << "\n"; });
  }
}

int simulate(const Arguments& arguments) {
  return run_in_folder(arguments.output, {}, [&](OutputFolder&, Progress& progress) {
    if (arguments.trace) print_trace(arguments.first_seed, arguments.seeds);
    const SeedRangeResult all = progress.step("rehearse", [&](const PartDone& done) {
      return simulate_seeds(arguments.first_seed, arguments.seeds, done);
    });
    return CommandResult{fault_simulation_report(all),
                         fault_simulation_summary(all),
                         all.failed.empty() ? kDone : kFailed};
  });
}

}  // namespace

Command add_rehearse_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = add_subcommand(
      app, "rehearse", "Play probe, link, board and volumes under seeded faults on virtual time");
  add_output_options(command, arguments->output);
  add_integer(command, "--seeds", arguments->seeds, "How many", 1, 100000000);
  add_seed(command, "--first-seed", arguments->first_seed, "The first; the others follow");
  add_flag(command, "--trace", arguments->trace, "Every event on stderr");
  return {&command, [arguments] { return simulate(*arguments); }};
}

}  // namespace wobblebench::bench
