// Pictures worked on row by row.
#pragma once

#include <tbb/parallel_for.h>

namespace wobblebench::render {

/// Calls row_function(row) for all rows, in parallel; rows must not depend on each other, so the
/// result is the same at any thread count.
template <class RowFunction>
void for_each_row(int rows, const RowFunction& row_function) {
  tbb::parallel_for(0, rows, row_function);
}

}  // namespace wobblebench::render
