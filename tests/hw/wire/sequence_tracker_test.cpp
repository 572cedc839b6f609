#include "hw/wire/stream_audit.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/hw/support/streams.h"

namespace wobblebench::hw {
namespace {

/// One stick arrives, and is delivered if it is the next one.
bool arrive(SequenceTracker& tracker, std::uint64_t sequence, bool after_damage = false) {
  tracker.advance_to(sequence, after_damage);
  if (!tracker.expects(sequence)) return false;
  tracker.deliver();
  return true;
}

TEST(SequenceTracker, StartsAtTheFirstSequenceNumber) {
  SequenceTracker tracker;
  EXPECT_FALSE(tracker.advance_to(1000, true));
  EXPECT_TRUE(arrive(tracker, 1000));
  EXPECT_EQ(tracker.account().emitted, 1U);
  EXPECT_EQ(tracker.account().lost.total(), 0U);
}

TEST(SequenceTracker, DistinguishesDamageFromLinkLoss) {
  SequenceTracker tracker;
  arrive(tracker, 0);
  const auto corrupt = tracker.advance_to(3, true);
  ASSERT_TRUE(corrupt);
  EXPECT_EQ(corrupt->first_sequence, 1U);
  EXPECT_EQ(corrupt->count, 2U);
  EXPECT_EQ(corrupt->cause, LossCause::corrupt);
  arrive(tracker, 3);
  const auto link = tracker.advance_to(9, false);
  ASSERT_TRUE(link);
  EXPECT_EQ(link->cause, LossCause::link);
  EXPECT_EQ(tracker.account().lost.corrupt, 2U);
  EXPECT_EQ(tracker.account().lost.link, 5U);
  EXPECT_EQ(tracker.account().emitted, 9U);
  EXPECT_TRUE(tracker.account().balanced());
}

TEST(SequenceTracker, LateStickIsOutOfOrderOnceThenDuplicate) {
  SequenceTracker tracker;
  arrive(tracker, 0);
  arrive(tracker, 5);
  EXPECT_FALSE(arrive(tracker, 3));
  EXPECT_FALSE(arrive(tracker, 3));
  EXPECT_FALSE(arrive(tracker, 0));
  EXPECT_EQ(tracker.account().lost.link, 3U);
  EXPECT_EQ(tracker.account().lost.out_of_order, 1U);
  EXPECT_EQ(tracker.account().duplicates, 2U);
  for (const std::uint64_t late : {1U, 2U, 4U}) EXPECT_FALSE(arrive(tracker, late));
  EXPECT_EQ(tracker.account().lost.link, 0U);
  EXPECT_EQ(tracker.account().lost.out_of_order, 4U);
  EXPECT_TRUE(tracker.account().balanced());
}

TEST(SequenceTracker, RestartKeepsTheCounts) {
  SequenceTracker tracker;
  for (std::uint64_t i = 0; i < 5; ++i) arrive(tracker, i);
  tracker.restart();
  EXPECT_TRUE(arrive(tracker, 2));
  EXPECT_EQ(tracker.account().emitted, 6U);
  EXPECT_EQ(tracker.account().duplicates, 0U);
}

TEST(SequenceTracker, BalancesAtRandom) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    SequenceTracker tracker;
    std::uint64_t head = hash(seed, 0) % 100;
    const std::uint64_t base = head;
    tracker.advance_to(base, false);
    for (std::uint64_t i = 1; i < 5000; ++i) {
      const std::uint64_t draw = hash(seed, i);
      const bool backwards = draw % 5 == 0;
      const std::uint64_t step = (draw >> 8) % 4;
      const std::uint64_t sequence =
          backwards ? head - std::min(head - base, (draw >> 8) % 50) : head + step;
      tracker.advance_to(sequence, draw % 7 == 0);
      if (tracker.expects(sequence)) {
        if (draw % 11 == 0) {
          tracker.lose(LossCause::ring_full);
        } else {
          tracker.deliver();
        }
      }
      head = std::max(head, sequence + 1);
      ASSERT_TRUE(tracker.account().balanced());
      ASSERT_EQ(tracker.account().emitted, tracker.next().value() - base);
    }
    EXPECT_GT(tracker.account().lost.out_of_order, 0U);
  }
}

TEST(SequenceTracker, LargestJumpBalances) {
  SequenceTracker tracker;
  arrive(tracker, 0);
  EXPECT_TRUE(arrive(tracker, std::numeric_limits<std::uint64_t>::max() - 1));
  EXPECT_TRUE(tracker.account().balanced());
}

}  // namespace
}  // namespace wobblebench::hw
