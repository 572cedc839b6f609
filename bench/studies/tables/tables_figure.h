// Tables I to IV as one picture.
#pragma once

#include "bench/output/chart/chart.h"
#include "bench/studies/tables/measure.h"

namespace wobblebench::bench {

/// Four panels, one a table: time relative to the reference row, the paper's, plain and fast.
Picture3 draw_tables(const TableResults& results);

}  // namespace wobblebench::bench
