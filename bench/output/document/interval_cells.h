// Means over seeds as cells of tables.
#pragma once

#include "bench/evaluation/seed_statistics.h"
#include "bench/output/document/table.h"

namespace wobblebench::bench {

/// The mean with its interval; nothing where there are no values.
inline Cell interval_cell(const MeanInterval& interval) {
  return interval.n > 0 ? Cell::interval(interval.mean, interval.half) : Cell();
}

/// The same of a difference: in brackets where it is not told from 0.
inline Cell difference_cell(const MeanInterval& interval) {
  return interval_cell(interval).bracket(!interval.differs_from_zero());
}

}  // namespace wobblebench::bench
