#include "bench/cli/table_options.h"

#include <CLI/CLI.hpp>

namespace wobblebench::bench {

TableRun TableArguments::run() const {
  const int size = full ? 1 : divisor;
  // A picture of the plain pipeline takes seconds at the paper's sizes, on a CPU.
  const int plain = plain_repeats > 0 ? plain_repeats : size == 1 ? 1 : repeats;
  return {.divisor = size, .repeats = repeats, .plain_repeats = plain};
}

void add_table_options(CLI::App& command, TableArguments& arguments) {
  auto* full = command.add_flag(
      "--full", arguments.full, "The paper's sizes; otherwise half of them a side");
  command.add_option("--divisor", arguments.divisor, "Sides are the paper's over this")
      ->check(CLI::IsMember({1, 2, 4, 8}))
      ->capture_default_str()
      ->excludes(full);
  command.add_option("--repeats", arguments.repeats, "Counted runs of each setting, fast pipeline")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command
      .add_option("--plain-repeats",
                  arguments.plain_repeats,
                  "Likewise, plain pipeline; default: 1 with the paper's sizes, else as --repeats")
      ->check(CLI::Range(1, 100));
}

}  // namespace wobblebench::bench
