#include "bench/exchange/program/renderer_process.h"

#include <gtest/gtest.h>
#include <poll.h>

#include <algorithm>
#include <atomic>

namespace {
std::atomic<int> longest_ms = 0;
}

/// In place of the system's.
extern "C" int poll(pollfd* watched, nfds_t count, int ms) {
  longest_ms = std::max(longest_ms.load(), ms);
  const timespec time{ms / 1000, ms % 1000 * 1'000'000};
  return ::ppoll(watched, count, ms < 0 ? nullptr : &time, nullptr);
}

namespace wobblebench::bench {

TEST(RendererProcess, IsWaitedForAsLongAsIsSaid) {
  RendererProcess process("it", "sed -u s/a/b/");
  EXPECT_EQ(process.ask("a", std::chrono::seconds(3000)), "b");
  EXPECT_GT(longest_ms, 2'900'000);
}

}  // namespace wobblebench::bench
