// Loops over independent sticks or frames.
#pragma once

#include <functional>

namespace wobblebench {

/// Calls body(first, last) over [0, count) in pieces, on `threads` threads (0: all of them). Bodies
/// must be independent: then results do not depend on the number of threads.
void parallel_ranges(int count, int threads, const std::function<void(int, int)>& body);

/// Calls body(row) for all of [0, rows), on all threads; the same condition and promise.
void parallel_rows(int rows, const std::function<void(int)>& body);

}  // namespace wobblebench
