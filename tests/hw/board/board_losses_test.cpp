// Losses: every stick is delivered or counted as lost, once.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <thread>

#include "tests/hw/support/collect.h"
#include "tests/hw/support/memory_link.h"
#include "tests/hw/support/streams.h"

namespace wobblebench::hw {
namespace {

struct Outcome {
  Collected seen;
  BoardAccount account;
  bool truncated = false;
};

Outcome run(const Bytes& stream, const BoardOptions& options = {}) {
  Board board(std::make_unique<MemoryLink>(stream, MemoryLinkOptions{.chunk_seed = 9}), options);
  board.start();
  Outcome outcome;
  const Event last = collect(board, outcome.seen);
  EXPECT_TRUE(std::holds_alternative<EndOfStream>(last));
  if (const auto* end = std::get_if<EndOfStream>(&last)) outcome.truncated = end->truncated;
  outcome.account = board.account();
  EXPECT_TRUE(outcome.account.balanced());
  EXPECT_EQ(outcome.account.delivered, outcome.seen.sticks.size());
  return outcome;
}

/// Sticks and gaps, in order, cover every sequence number from `first` to `last` once.
void expect_seamless(const Collected& seen, std::uint64_t first, std::uint64_t last) {
  ASSERT_EQ(seen.order.size(), last - first + 1);
  for (std::size_t i = 0; i < seen.order.size(); ++i) ASSERT_EQ(seen.order[i], first + i);
}

void expect_gap(const Gap& gap, std::uint64_t first, std::uint64_t count, LossCause cause) {
  EXPECT_EQ(gap.first_sequence, first);
  EXPECT_EQ(gap.count, count);
  EXPECT_EQ(gap.cause, cause);
}

TEST(BoardLosses, MissingPacketsAreLinkLosses) {
  const AcquisitionPlan plan = small_plan(2);
  auto packets = packets_of(plan);
  for (const std::uint64_t sequence : {3U, 4U, 11U, 12U})
    packets[packet_index(plan, sequence)] = {};
  const Outcome outcome = run(join(packets));
  expect_seamless(outcome.seen, 0, 23);
  ASSERT_EQ(outcome.seen.gaps.size(), 3U);
  expect_gap(outcome.seen.gaps[0], 3, 2, LossCause::link);
  expect_gap(outcome.seen.gaps[1], 11, 1, LossCause::link);
  expect_gap(outcome.seen.gaps[2], 12, 1, LossCause::link);
  EXPECT_EQ(outcome.account.lost.link, 4U);
  EXPECT_EQ(outcome.account.emitted, 24U);
}

TEST(BoardLosses, DamagedPacketsAreCorrupt) {
  const AcquisitionPlan plan = small_plan(2);
  auto packets = packets_of(plan);
  packets[packet_index(plan, 5)][70] ^= std::byte{1};
  packets[packet_index(plan, 15)].pop_back();
  packets[packet_index(plan, 20)] = {};
  const Outcome outcome = run(join(packets));
  expect_seamless(outcome.seen, 0, 23);
  ASSERT_EQ(outcome.seen.gaps.size(), 3U);
  expect_gap(outcome.seen.gaps[0], 5, 1, LossCause::corrupt);
  expect_gap(outcome.seen.gaps[1], 15, 1, LossCause::corrupt);
  expect_gap(outcome.seen.gaps[2], 20, 1, LossCause::link);
}

TEST(BoardLosses, DamageOutsideSticksLosesNone) {
  const AcquisitionPlan plan = small_plan(2);
  auto packets = packets_of(plan);
  packets[13][20] ^= std::byte{1};  // the first volume's end
  packets[14][80] ^= std::byte{1};  // the second volume's configuration
  packets[packet_index(plan, 18)] = {};
  const Outcome outcome = run(join(packets));
  EXPECT_EQ(outcome.account.delivered, 23U);
  EXPECT_EQ(outcome.account.lost.link, 1U) << "earlier damage does not make a later loss corrupt";
  EXPECT_EQ(outcome.seen.ends.size(), 1U);
}

TEST(BoardLosses, LateSticksAreOutOfOrderAndRepeatedOnesDuplicates) {
  const AcquisitionPlan plan = small_plan(1);
  auto packets = packets_of(plan);
  std::swap(packets[packet_index(plan, 4)], packets[packet_index(plan, 6)]);
  const auto nine = packet_index(plan, 9);
  packets[nine].insert(packets[nine].end(), packets[nine - 3].begin(), packets[nine - 3].end());
  packets.push_back(packets.back());
  const Outcome outcome = run(join(packets));
  // 0-3, then 6 (4 and 5 are missing), 5 and 4 late, 7 and so on.
  expect_seamless(outcome.seen, 0, 11);
  ASSERT_EQ(outcome.seen.gaps.size(), 1U);
  expect_gap(outcome.seen.gaps[0], 4, 2, LossCause::link);
  EXPECT_EQ(outcome.account.lost.out_of_order, 2U);
  EXPECT_EQ(outcome.account.lost.link, 0U);
  EXPECT_GE(outcome.account.duplicates, 1U);
  EXPECT_EQ(outcome.account.emitted, 12U);
  EXPECT_EQ(outcome.seen.ends.size(), 1U);
}

TEST(BoardLosses, SticksThatContradictTheConfigurationAreCorrupt) {
  const AcquisitionPlan plan = small_plan(1);
  auto packets = packets_of(plan);
  Stick long_stick = test_stick(plan, 2);
  long_stick.samples.push_back(0.5F);
  Stick outside = test_stick(plan, 5);
  outside.index.line = 4;
  Stick elsewhere = test_stick(plan, 8);
  elsewhere.sequence = 9000000000;
  for (const auto& [sequence, stick] :
       {std::pair(2, &long_stick), std::pair(5, &outside), std::pair(8, &elsewhere)}) {
    Bytes& packet = packets[packet_index(plan, static_cast<std::uint64_t>(sequence))];
    packet.clear();
    encode(*stick, packet);
  }
  const Outcome outcome = run(join(packets));
  expect_seamless(outcome.seen, 0, 11);
  EXPECT_EQ(outcome.account.lost.corrupt, 3U);
  EXPECT_EQ(outcome.account.emitted, 12U);
  for (const Gap& gap : outcome.seen.gaps) EXPECT_EQ(gap.cause, LossCause::corrupt);
}

TEST(BoardLosses, UncheckedVolumeEndWithAWrongNumberIsIgnored) {
  const AcquisitionPlan plan = small_plan(2);
  auto packets = packets_of(plan, WireCrc::none);
  packets[13][22] ^= std::byte{0x40};
  const Outcome outcome = run(join(packets));
  EXPECT_EQ(outcome.account.emitted, 24U);
  EXPECT_EQ(outcome.account.delivered, 24U);
}

TEST(BoardLosses, SticksBeforeAnyConfigurationAreCountedAsLost) {
  const AcquisitionPlan plan = small_plan(2);
  auto packets = packets_of(plan);
  auto unannounced = packets;
  unannounced[0] = {};
  const Outcome missed = run(join(unannounced));
  expect_seamless(missed.seen, 0, 23);
  EXPECT_EQ(missed.account.lost.link, 12U);
  packets[0][100] ^= std::byte{1};
  const Outcome damaged = run(join(packets));
  EXPECT_EQ(damaged.account.emitted, 24U);
  EXPECT_EQ(damaged.account.delivered, 12U);
  EXPECT_GE(damaged.account.lost.corrupt, 1U);
}

TEST(BoardLosses, StreamMayStartAtAnyVolume) {
  const AcquisitionPlan plan = small_plan(3);
  auto packets = packets_of(plan);
  packets.erase(packets.begin(), packets.begin() + 14);
  const Outcome outcome = run(join(packets));
  expect_seamless(outcome.seen, 12, 35);
  EXPECT_EQ(outcome.account.emitted, 24U);
  EXPECT_EQ(outcome.account.lost.total(), 0U);
  EXPECT_FALSE(outcome.truncated);
}

TEST(BoardLosses, TruncationIsReported) {
  const AcquisitionPlan plan = small_plan(1);
  auto packets = packets_of(plan);
  packets.pop_back();
  EXPECT_TRUE(run(join(packets)).truncated) << "inside a volume";
  Bytes inside_packet = stream_of(plan);
  inside_packet.resize(inside_packet.size() + 10, kWireMagic[0]);
  EXPECT_TRUE(run(inside_packet).truncated);
  EXPECT_FALSE(run(stream_of(plan)).truncated);
  EXPECT_FALSE(run({}).truncated);
}

TEST(BoardLosses, SamplesAreDeliveredBitForBitNanIncluded) {
  const AcquisitionPlan plan = small_plan(1);
  auto packets = packets_of(plan);
  Stick stick = test_stick(plan, 7);
  stick.samples[2] = std::nanf("");
  packets[packet_index(plan, 7)].clear();
  encode(stick, packets[packet_index(plan, 7)]);
  const Outcome outcome = run(join(packets));
  ASSERT_EQ(outcome.seen.sticks.size(), 12U);
  EXPECT_TRUE(std::isnan(outcome.seen.sticks[7].samples[2]));
}

MemoryLinkOptions overrunning() {
  return {.waits_for_reader = false};
}

TEST(BoardLosses, FullRingDropsAreCountedAndReported) {
  const AcquisitionPlan plan = small_plan(2);
  Board board(std::make_unique<MemoryLink>(stream_of(plan), overrunning()), {.ring_slots = 5});
  board.start();
  // No event is taken until the link has been read to its end.
  while (board.account().emitted < 24) std::this_thread::yield();
  EXPECT_EQ(board.account().delivered, 5U);
  EXPECT_EQ(board.account().lost.ring_full, 19U);
  Collected seen;
  const Event last = collect(board, seen);
  EXPECT_TRUE(std::holds_alternative<EndOfStream>(last));
  expect_seamless(seen, 0, 23);
  ASSERT_EQ(seen.sticks.size(), 5U);
  for (std::uint64_t i = 0; i < 5; ++i) EXPECT_TRUE(is_genuine(plan, seen.sticks[i]));
  for (const Gap& gap : seen.gaps) EXPECT_EQ(gap.cause, LossCause::ring_full);
  EXPECT_EQ(seen.ends.size(), 2U);
  EXPECT_TRUE(board.account().balanced());
}

TEST(BoardLosses, LongStallKeepsTheQueueBoundedAndTheCountsExact) {
  const AcquisitionPlan plan = small_plan(1000);
  auto packets = packets_of(plan);
  std::uint64_t dropped = 0;
  for (std::uint64_t i = 20; i < 12000 - 1; i += 3, ++dropped) packets[packet_index(plan, i)] = {};
  Board board(std::make_unique<MemoryLink>(join(packets), overrunning()), {.ring_slots = 4});
  board.start();
  while (board.account().emitted < 12000) std::this_thread::yield();
  const BoardAccount account = board.account();
  EXPECT_EQ(account.delivered, 4U);
  EXPECT_EQ(account.lost.link, dropped);
  EXPECT_EQ(account.lost.ring_full, 12000 - 4 - dropped);
  Collected seen;
  collect(board, seen);
  expect_seamless(seen, 0, 11999);
  EXPECT_LE(seen.gaps.size() + seen.ends.size(), 4U + 256U + 1U);
}

TEST(BoardLosses, SlowReaderGetsEveryStickOnceOrItsGap) {
  const AcquisitionPlan plan = small_plan(40);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    MemoryLinkOptions options = overrunning();
    options.chunk_seed = seed;
    Board board(std::make_unique<MemoryLink>(stream_of(plan), options), {.ring_slots = 3});
    board.start();
    Collected seen;
    for (std::uint64_t i = 0;; ++i) {
      const Event event = board.next(patience());
      if (!note(event, seen)) break;
      if (hash(seed, i) % 3 == 0) std::this_thread::yield();
      ASSERT_TRUE(board.account().balanced());
    }
    expect_seamless(seen, 0, 479);
    for (const Stick& stick : seen.sticks) ASSERT_TRUE(is_genuine(plan, stick));
    const BoardAccount account = board.account();
    EXPECT_EQ(account.emitted, 480U);
    EXPECT_EQ(account.delivered, seen.sticks.size());
    EXPECT_EQ(account.lost.ring_full, account.lost.total());
  }
}

TEST(BoardLosses, MixedFaultsBalance) {
  const AcquisitionPlan plan = small_plan(6);
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    auto packets = packets_of(plan);
    std::set<std::uint64_t> touched;
    for (std::uint64_t fault = 0; fault < hash(seed, 0) % 10; ++fault) {
      const std::uint64_t sequence = hash(seed, 3 * fault + 1) % 71;
      Bytes& packet = packets[packet_index(plan, sequence)];
      touched.insert(sequence);
      switch (hash(seed, 3 * fault + 2) % 4) {
        case 0:
          packet.clear();
          break;
        case 1:
          packet.insert(packet.end(), packet.begin(), packet.end());
          break;
        case 2:
          if (!packet.empty()) packet[hash(seed, 3 * fault + 3) % packet.size()] ^= std::byte{8};
          break;
        case 3:
          std::swap(packet, packets[packet_index(plan, sequence + 1)]);
          touched.insert(sequence + 1);
          break;
      }
    }
    const Outcome outcome = run(join(packets), {.ring_slots = 1 + static_cast<int>(seed % 9)});
    expect_seamless(outcome.seen, 0, 71);
    ASSERT_EQ(outcome.account.emitted, 72U);
    ASSERT_EQ(outcome.account.lost.ring_full, 0U);
    ASSERT_LE(outcome.account.lost.total(), touched.size()) << "seed " << seed;
    for (const Stick& stick : outcome.seen.sticks) ASSERT_TRUE(is_genuine(plan, stick));
  }
}

}  // namespace
}  // namespace wobblebench::hw
