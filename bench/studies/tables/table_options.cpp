#include "bench/studies/tables/table_options.h"

#include <CLI/CLI.hpp>

#include "bench/command/common_options.h"

namespace wobblebench::bench {

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

}  // namespace wobblebench::bench
