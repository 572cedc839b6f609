#include "hw/board/ring.h"

#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <thread>

#include "base/options.h"
#include "hw/board/board.h"

namespace wobblebench::hw {
namespace {

TEST(StickRing, HasAFixedNumberOfSlots) {
  StickRing ring(3);
  std::set<Stick*> taken;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(ring.free_slots(), 3 - i);
    EXPECT_TRUE(taken.insert(ring.acquire()).second);
  }
  EXPECT_EQ(taken.count(nullptr), 0U);
  EXPECT_EQ(ring.acquire(), nullptr);
  ring.release(*taken.begin());
  EXPECT_EQ(ring.free_slots(), 1);
  EXPECT_EQ(ring.acquire(), *taken.begin());
}

TEST(StickRing, RejectsSizesOutOfRange) {
  for (const int slots : {0, -1, kMaxRingSlots + 1}) EXPECT_THROW(StickRing{slots}, InvalidOption);
}

TEST(StickRing, WaitsForARelease) {
  StickRing ring(1);
  Stick* slot = ring.acquire();
  std::jthread releaser([&] { ring.release(slot); });
  EXPECT_EQ(ring.wait(std::stop_token()), slot);
}

TEST(StickRing, StopEndsTheWait) {
  StickRing ring(1);
  ASSERT_NE(ring.acquire(), nullptr);
  std::stop_source stop;
  std::jthread stopper([&] { stop.request_stop(); });
  EXPECT_EQ(ring.wait(stop.get_token()), nullptr);
}

TEST(StickRing, NoTwoThreadsHoldOneSlot) {
  StickRing ring(3);
  std::atomic<int> clashes{0};
  const auto work = [&](std::uint64_t id) {
    for (int i = 0; i < 3000; ++i) {
      Stick* slot = ring.wait(std::stop_token());
      slot->sequence = id;
      std::this_thread::yield();
      if (slot->sequence != id) ++clashes;
      ring.release(slot);
    }
  };
  std::vector<std::jthread> threads;
  for (std::uint64_t id = 0; id < 5; ++id) threads.emplace_back(work, id);
  threads.clear();  // joins
  EXPECT_EQ(clashes, 0);
  EXPECT_EQ(ring.free_slots(), 3);
}

}  // namespace
}  // namespace wobblebench::hw
