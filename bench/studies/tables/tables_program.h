// wobblebench-tables: Tables I to IV from a recording, on a machine that has a GPU and little else;
// and the options that `wobblebench tables` shares with it.
#pragma once

#include "bench/command/program.h"
#include "bench/studies/tables/paper.h"

namespace wobblebench::bench {

struct TableArguments {
  bool full = false;
  int divisor = 2;
  int repeats = 3;
  int plain_repeats = 0;  ///< 0: 1 with the paper's sizes, otherwise as many as repeats

  TableRun run() const;
};

void add_table_options(CLI::App& command, TableArguments& arguments);

/// The program that main() of wobblebench-tables runs.
Program tables_program();

}  // namespace wobblebench::bench
