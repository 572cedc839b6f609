// wobblebench-tables: Tables I to IV from a recording, on a machine that has a GPU and little else.
#pragma once

#include "bench/command/program.h"

namespace wobblebench::bench {

/// What its main() runs.
Program tables_program();

}  // namespace wobblebench::bench
