// Throughput of the board and latency of its cancel(). Measured, never asserted.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/part_done.h"
#include "base/statistics.h"

namespace wobblebench::bench {

/// A part of the path of a recording, MB/s (1e6 bytes per second) on one core.
struct StageSpeed {
  std::string stage;
  Spread mb_s;
};

struct Throughput {
  std::uint64_t bytes = 0;
  std::uint64_t sticks = 0;
  double stream_mb_s = 0;  ///< of a probe in real time
  int repeats = 0;
  std::vector<StageSpeed> stages;  ///< from the copy alone to the whole path
};

/// A recording of the paper's sticks with noise for samples, `volumes` of them, in a temporary file
/// in the page cache; read, checked, decoded, and played through the board to a reader that takes
/// and releases every stick, all threads on one core. One warm-up run, then `repeats`.
/// Throws std::runtime_error where the file cannot be written.
Throughput measure_throughput(int volumes, int repeats, const PartDone& done = {});

struct CancelTimes {
  int cancels = 0;
  int load_threads = 0;  ///< busy loops beside it
  double p50_ms = 0, p99_ms = 0, p999_ms = 0, max_ms = 0;
};

/// Wall time from the call of cancel() until the thread that waits in next() has returned, while a
/// card sends in real time and `load_threads` threads keep the processors busy.
CancelTimes measure_cancels(int cancels, int load_threads, const PartDone& done = {});

}  // namespace wobblebench::bench
