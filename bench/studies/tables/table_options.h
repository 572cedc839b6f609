// The options of `tables`, as wobblebench and wobblebench-tables both take them.
#pragma once

#include "bench/studies/tables/variant.h"

namespace CLI {
class App;
}

namespace wobblebench::bench {

struct TableArguments {
  bool full = false;
  int divisor = 2;
  int repeats = 3;
  int plain_repeats = 0;  ///< 0: 1 with the paper's sizes, otherwise as many as repeats

  TableRun run() const;
};

void add_table_options(CLI::App& command, TableArguments& arguments);

}  // namespace wobblebench::bench
