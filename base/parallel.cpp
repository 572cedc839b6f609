#include "base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace wobblebench {

void parallel_ranges(int count, int threads, const std::function<void(int, int)>& body) {
  // More threads than cores are allowed: a test of independence from their number asks for them.
  using Limit = tbb::global_control;
  const auto most = std::max<std::size_t>(Limit::active_value(Limit::max_allowed_parallelism),
                                          static_cast<std::size_t>(threads));
  const Limit limit(Limit::max_allowed_parallelism, most);
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<int>(0, count), [&](const tbb::blocked_range<int>& range) {
      body(range.begin(), range.end());
    });
  });
}

void parallel_rows(int rows, const std::function<void(int)>& body) {
  tbb::parallel_for(0, rows, body);
}

}  // namespace wobblebench
