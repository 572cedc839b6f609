#include "hw/board/board.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <thread>

#include "base/options.h"
#include "hw/wire/crc32c.h"
#include "tests/hw/support/collect.h"
#include "tests/hw/support/memory_link.h"
#include "tests/hw/support/streams.h"

namespace wobblebench::hw {
namespace {

constexpr HostTime kNow = HostTime::min();

std::unique_ptr<MemoryLink> link_of(Bytes bytes, const MemoryLinkOptions& options = {}) {
  return std::make_unique<MemoryLink>(std::move(bytes), options);
}

MemoryLinkOptions idle_link() {
  return {.ending = ReadStatus::timeout};
}

TEST(Board, DeliversAnIntactStreamCompletelyAndInOrder) {
  const AcquisitionPlan plan = small_plan(5);
  Board board(link_of(stream_of(plan), {.chunk_seed = 3}));
  EXPECT_EQ(board.state(), BoardState::open);
  board.start();
  Collected seen;
  const Event last = collect(board, seen);
  ASSERT_TRUE(std::holds_alternative<EndOfStream>(last));
  EXPECT_FALSE(std::get<EndOfStream>(last).truncated);
  ASSERT_EQ(seen.sticks.size(), 60U);
  for (std::uint64_t i = 0; i < 60; ++i) {
    EXPECT_EQ(seen.sticks[i].sequence, i);
    EXPECT_TRUE(is_genuine(plan, seen.sticks[i]));
  }
  ASSERT_EQ(seen.configurations.size(), 1U);
  EXPECT_TRUE(seen.configurations[0].plan.acquisition() == plan.acquisition());
  EXPECT_EQ(seen.configurations[0].source, StreamOrigin::simulated);
  EXPECT_EQ(seen.ends.size(), 5U);
  EXPECT_TRUE(seen.gaps.empty());
  EXPECT_EQ(board.account().emitted, 60U);
  EXPECT_EQ(board.account().delivered, 60U);
  EXPECT_EQ(board.damage().regions, 0U);
  EXPECT_EQ(board.capabilities().origin, StreamOrigin::emulator);
}

TEST(Board, WaitingLinkLosesNothingToASmallRing) {
  const AcquisitionPlan plan = small_plan(50);
  Board board(link_of(stream_of(plan)), {.ring_slots = 1});
  board.start();
  Collected seen;
  collect(board, seen);
  EXPECT_EQ(seen.sticks.size(), 600U);
  EXPECT_TRUE(seen.gaps.empty());
  EXPECT_EQ(board.account().delivered, 600U);
  EXPECT_EQ(board.account().lost.total(), 0U);
}

TEST(Board, NeverWritesASlotThatIsHeld) {
  const AcquisitionPlan plan = small_plan(20);
  auto board = std::make_unique<Board>(link_of(stream_of(plan)), BoardOptions{.ring_slots = 3});
  board->start();
  std::vector<StickSlot> held;
  for (std::uint64_t taken = 0; taken < 240;) {
    Event event = board->next(patience());
    if (auto* slot = std::get_if<StickSlot>(&event)) {
      if (taken++ % 100 == 0 && held.size() < 2) held.push_back(std::move(*slot));
    }
  }
  ASSERT_EQ(held.size(), 2U);
  EXPECT_EQ(board->free_slots(), 1);
  board->close();
  board.reset();
  EXPECT_EQ(held[0]->sequence, 0U);
  EXPECT_EQ(held[1]->sequence, 100U);
  for (const StickSlot& slot : held) EXPECT_TRUE(is_genuine(plan, *slot));
}

TEST(Board, ReleasedSlotsAreFree) {
  Board board(link_of(stream_of(small_plan(1))), {.ring_slots = 100});
  board.start();
  Collected seen;
  collect(board, seen);
  EXPECT_EQ(board.free_slots(), 100);
}

TEST(Board, PastDeadlinePollsAndLaterOneIsKept) {
  Board board(link_of({}, idle_link()));
  board.start();
  EXPECT_TRUE(std::holds_alternative<TimedOut>(board.next(kNow)));
  const HostTime deadline = HostClock::now() + std::chrono::milliseconds(20);
  EXPECT_TRUE(std::holds_alternative<TimedOut>(board.next(deadline)));
  EXPECT_GE(HostClock::now(), deadline);
}

TEST(Board, PollingReturnsQueuedEvents) {
  Board board(link_of(stream_of(small_plan(1))));
  board.start();
  while (board.account().delivered < 12) std::this_thread::yield();
  Collected seen;
  while (note(board.next(kNow), seen)) {
  }
  EXPECT_EQ(seen.sticks.size(), 12U);
}

/// A waiter that nobody woke would say so, too, when its own deadline has passed.
TEST(Board, CancelWakesAWaiterAndStartContinues) {
  Board board(link_of(stream_of(small_plan(2)), idle_link()));
  board.start();
  Collected seen;
  while (seen.sticks.size() < 10) note(board.next(patience()), seen);
  for (int i = 0; i < 20; ++i) {
    auto waiter = std::async(std::launch::async, [&] { return collect(board, seen); });
    std::this_thread::sleep_for(std::chrono::milliseconds(1));  // most times it waits by then
    board.cancel();
    board.cancel();
    ASSERT_EQ(waiter.wait_for(std::chrono::seconds(20)), std::future_status::ready);
    EXPECT_TRUE(std::holds_alternative<Cancelled>(waiter.get()));
    EXPECT_TRUE(std::holds_alternative<Cancelled>(board.next(kNow)));
    board.start();
  }
  while (seen.sticks.size() < 24) ASSERT_TRUE(note(board.next(patience()), seen));
  for (std::uint64_t i = 0; i < 24; ++i) EXPECT_EQ(seen.order[i], i);
  EXPECT_EQ(board.account().lost.total(), 0U);
}

TEST(Board, StopAndCancelAnywhereLoseNothing) {
  const AcquisitionPlan plan = small_plan(4);
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Board board(link_of(stream_of(plan), {.chunk_seed = seed}), {.ring_slots = 2});
    board.start();
    Collected seen;
    bool ended = false;
    for (std::uint64_t i = 0; !ended; ++i) {
      const Event event = board.next(patience());
      note(event, seen);
      ended = std::holds_alternative<EndOfStream>(event);
      if (hash(seed, i) % 4 == 0 && !ended) {
        hash(seed, i) % 8 == 0 ? board.stop() : board.cancel();
        board.start();
      }
    }
    ASSERT_EQ(seen.sticks.size(), 48U);
    for (std::uint64_t i = 0; i < 48; ++i) ASSERT_EQ(seen.sticks[i].sequence, i);
    ASSERT_TRUE(board.account().balanced());
  }
}

TEST(Board, CancelEndsBackpressure) {
  Board board(link_of(stream_of(small_plan(3))), {.ring_slots = 1});
  board.start();
  while (board.free_slots() > 0) std::this_thread::yield();
  board.stop();
  EXPECT_EQ(board.state(), BoardState::configured);
  Collected seen;
  EXPECT_TRUE(std::holds_alternative<Stopped>(collect(board, seen)));
  EXPECT_EQ(seen.sticks.size(), 1U);
}

TEST(Board, StatesAndIllegalCalls) {
  Board board(link_of(stream_of(small_plan(1)), idle_link()));
  EXPECT_THROW(static_cast<void>(board.next(kNow)), IllegalBoardCall);
  board.stop();
  EXPECT_EQ(board.state(), BoardState::open);
  board.start();
  EXPECT_EQ(board.state(), BoardState::running);
  EXPECT_THROW(board.start(), IllegalBoardCall);
  EXPECT_EQ(board.state(), BoardState::running);
  while (board.account().delivered < 12) std::this_thread::yield();
  board.stop();
  board.stop();
  EXPECT_EQ(board.state(), BoardState::configured);
  Collected seen;
  EXPECT_TRUE(std::holds_alternative<Stopped>(collect(board, seen)));
  EXPECT_EQ(seen.sticks.size(), 12U);
  board.close();
  board.close();
  EXPECT_EQ(board.state(), BoardState::closed);
  EXPECT_THROW(board.start(), IllegalBoardCall);
  EXPECT_THROW(static_cast<void>(board.next(kNow)), IllegalBoardCall);
  board.stop();
  board.cancel();
  EXPECT_EQ(board.state(), BoardState::closed);
}

TEST(Board, StoppedBeforeAnyConfigurationIsOpen) {
  Board board(link_of({}, idle_link()));
  board.start();
  board.stop();
  EXPECT_EQ(board.state(), BoardState::open);
}

TEST(Board, RejectsInvalidArguments) {
  EXPECT_THROW(Board(nullptr), std::invalid_argument);
  EXPECT_THROW(Board(link_of({}), {.ring_slots = 0}), InvalidOption);
  EXPECT_NO_THROW(check_options(BoardOptions{}));
}

TEST(Board, UnpluggedDeviceIsLostAfterEarlierSticks) {
  Board board(link_of(stream_of(small_plan(1)), {.ending = ReadStatus::lost}));
  board.start();
  Collected seen;
  const Event last = collect(board, seen);
  ASSERT_TRUE(std::holds_alternative<DeviceLost>(last));
  EXPECT_EQ(std::get<DeviceLost>(last).cause, DeviceLossCause::unplugged);
  EXPECT_EQ(std::get<DeviceLost>(last).reason, "the device is gone");
  EXPECT_EQ(seen.sticks.size(), 12U);
  EXPECT_EQ(board.state(), BoardState::lost);
  EXPECT_THROW(board.start(), IllegalBoardCall);
  board.stop();
  EXPECT_EQ(board.state(), BoardState::lost);
  EXPECT_TRUE(std::holds_alternative<DeviceLost>(board.next(kNow)));
}

TEST(Board, LaterWireVersionIsReported) {
  // A volume end of version 2 with a correct CRC.
  Bytes stream;
  encode(VolumeEndPacket{}, stream);
  stream[4] = std::byte{2};
  const auto all = std::span<const std::byte>(stream);
  const std::uint32_t crc = crc32c(all.first(60));
  for (std::size_t i = 0; i < 4; ++i) stream[60 + i] = std::byte(crc >> (8 * i) & 0xFF);
  Board board(link_of(stream));
  board.start();
  Collected seen;
  const Event last = collect(board, seen);
  ASSERT_TRUE(std::holds_alternative<DeviceLost>(last));
  EXPECT_EQ(std::get<DeviceLost>(last).cause, DeviceLossCause::unreadable);
  EXPECT_EQ(std::get<DeviceLost>(last).reason,
            "wire format version 2: this program reads version 1");
}

TEST(Board, ImpossibleConfigurationIsReported) {
  ConfigurationPacket packet;
  packet.acquisition.depth_m = -1;
  Bytes stream;
  encode(packet, stream);
  Board board(link_of(stream));
  board.start();
  Collected seen;
  const Event last = collect(board, seen);
  ASSERT_TRUE(std::holds_alternative<DeviceLost>(last));
  EXPECT_EQ(std::get<DeviceLost>(last).reason,
            "the device's configuration is not possible: "
            "depth_mm = -1000: must be within 1 and 400");
}

/// The same scan of another subject: its first stick is no repetition.
TEST(Board, AnotherSubjectStartsANewStream) {
  const AcquisitionPlan plan = small_plan(1);
  Bytes stream = stream_of(plan);
  ConfigurationPacket other = configuration_of(plan, 0);
  other.subject = {.phantom = 1, .placement = 2, .motion = 3};
  encode(other, stream);
  encode(test_stick(plan, 0), stream);
  Board board(link_of(stream));
  board.start();
  Collected seen;
  collect(board, seen);
  EXPECT_EQ(seen.configurations.size(), 2U);
  EXPECT_EQ(board.account().duplicates, 0U);
}

TEST(Board, NewConfigurationStartsANewStream) {
  const AcquisitionPlan first = small_plan(1);
  AcquisitionOptions changed = first.acquisition();
  changed.depth_m = 0.1;
  const AcquisitionPlan second({}, changed);
  Bytes stream = stream_of(first);
  const Bytes more = stream_of(second);
  stream.insert(stream.end(), more.begin(), more.end());
  Board board(link_of(stream));
  board.start();
  Collected seen;
  collect(board, seen);
  EXPECT_EQ(seen.configurations.size(), 2U);
  EXPECT_EQ(seen.sticks.size(), 24U);
  EXPECT_EQ(board.account().emitted, 24U);
  EXPECT_EQ(board.account().duplicates, 0U);
}

TEST(Board, SteppedBoardReadsOnlyInStep) {
  const AcquisitionPlan plan = small_plan(4);
  Board board(link_of(stream_of(plan), {.chunk_seed = 2}),
              {.ring_slots = 3, .reader = ReaderMode::stepped});
  EXPECT_THROW(board.step(), IllegalBoardCall);
  board.start();
  EXPECT_TRUE(std::holds_alternative<TimedOut>(board.next(kNow)));
  Collected seen;
  bool over = false;
  for (int step = 0; !over && step < 10000; ++step) {
    board.step();
    for (Event event = board.next(kNow); !over && !std::holds_alternative<TimedOut>(event);
         event = board.next(kNow)) {
      over = !note(event, seen);
    }
  }
  EXPECT_TRUE(over);
  EXPECT_EQ(seen.sticks.size(), 48U);
  EXPECT_FALSE(board.step()) << "the stream is over";
  Board threaded(link_of(stream_of(plan)));
  threaded.start();
  EXPECT_THROW(threaded.step(), IllegalBoardCall);
}

TEST(Board, ThreadsShareTheEvents) {
  Board board(link_of(stream_of(small_plan(100)), {.chunk_seed = 5}), {.ring_slots = 7});
  board.start();
  std::atomic<std::uint64_t> sticks{0}, sum{0};
  std::atomic<bool> unbalanced{false};
  const auto take = [&] {
    Collected seen;
    collect(board, seen);
    sticks += seen.sticks.size();
    for (const Stick& stick : seen.sticks) sum += stick.sequence;
  };
  std::vector<std::jthread> threads;
  for (int i = 0; i < 3; ++i) threads.emplace_back(take);
  while (sticks < 1200) {
    if (!board.account().balanced()) unbalanced = true;
    std::this_thread::yield();
  }
  threads.clear();  // joins
  EXPECT_EQ(sticks, 1200U);
  EXPECT_EQ(sum, 1199U * 1200U / 2);
  EXPECT_FALSE(unbalanced);
}

TEST(Board, StartStopAndCancelFromManyThreads) {
  Board board(link_of(stream_of(small_plan(20)), idle_link()), {.ring_slots = 5});
  board.start();
  const auto interfere = [&](std::uint64_t seed) {
    for (std::uint64_t i = 0; i < 200; ++i) {
      const std::uint64_t draw = hash(seed, i) % 4;
      if (draw == 0) board.stop();
      if (draw == 1) board.cancel();
      try {
        if (draw >= 2) board.start();
      } catch (const IllegalBoardCall&) {
        // Another thread started it first.
      }
      static_cast<void>(board.next(kNow));
    }
  };
  std::vector<std::jthread> threads;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) threads.emplace_back(interfere, seed);
  threads.clear();  // joins
  board.stop();
  EXPECT_TRUE(board.account().balanced());
  EXPECT_EQ(board.account().lost.total(), 0U);
}

}  // namespace
}  // namespace wobblebench::hw
