#include "hw/wire/account.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/hw/support/streams.h"

namespace wobblebench::hw {
namespace {

/// One stick arrives and is delivered if it is the one that comes next.
bool arrive(SequenceLedger& ledger, std::uint64_t sequence, bool after_damage = false) {
  ledger.advance_to(sequence, after_damage);
  if (!ledger.expects(sequence)) return false;
  ledger.deliver();
  return true;
}

TEST(SequenceLedger, BeginsWhereTheStreamBegins) {
  SequenceLedger ledger;
  EXPECT_FALSE(ledger.advance_to(1000, true));
  EXPECT_TRUE(arrive(ledger, 1000));
  EXPECT_EQ(ledger.account().emitted, 1U);
  EXPECT_EQ(ledger.account().lost.total(), 0U);
}

TEST(SequenceLedger, TellsDamageFromTheLink) {
  SequenceLedger ledger;
  arrive(ledger, 0);
  const auto corrupt = ledger.advance_to(3, true);
  ASSERT_TRUE(corrupt);
  EXPECT_EQ(corrupt->first_sequence, 1U);
  EXPECT_EQ(corrupt->count, 2U);
  EXPECT_EQ(corrupt->cause, LossCause::corrupt);
  arrive(ledger, 3);
  const auto link = ledger.advance_to(9, false);
  ASSERT_TRUE(link);
  EXPECT_EQ(link->cause, LossCause::link);
  EXPECT_EQ(ledger.account().lost.corrupt, 2U);
  EXPECT_EQ(ledger.account().lost.link, 5U);
  EXPECT_EQ(ledger.account().emitted, 9U);
  EXPECT_TRUE(ledger.account().balanced());
}

TEST(SequenceLedger, ALateStickIsOutOfOrderOnceThenADuplicate) {
  SequenceLedger ledger;
  arrive(ledger, 0);
  arrive(ledger, 5);
  EXPECT_FALSE(arrive(ledger, 3));
  EXPECT_FALSE(arrive(ledger, 3));
  EXPECT_FALSE(arrive(ledger, 0));
  EXPECT_EQ(ledger.account().lost.link, 3U);
  EXPECT_EQ(ledger.account().lost.out_of_order, 1U);
  EXPECT_EQ(ledger.account().duplicates, 2U);
  for (const std::uint64_t late : {1U, 2U, 4U}) EXPECT_FALSE(arrive(ledger, late));
  EXPECT_EQ(ledger.account().lost.link, 0U);
  EXPECT_EQ(ledger.account().lost.out_of_order, 4U);
  EXPECT_TRUE(ledger.account().balanced());
}

TEST(SequenceLedger, RestartCountsOn) {
  SequenceLedger ledger;
  for (std::uint64_t i = 0; i < 5; ++i) arrive(ledger, i);
  ledger.restart();
  EXPECT_TRUE(arrive(ledger, 2));
  EXPECT_EQ(ledger.account().emitted, 6U);
  EXPECT_EQ(ledger.account().duplicates, 0U);
}

TEST(SequenceLedger, BalancesOverAnyHistory) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    SequenceLedger ledger;
    std::uint64_t head = hash(seed, 0) % 100;
    const std::uint64_t base = head;
    ledger.advance_to(base, false);
    for (std::uint64_t i = 1; i < 5000; ++i) {
      const std::uint64_t draw = hash(seed, i);
      const bool backwards = draw % 5 == 0;
      const std::uint64_t step = (draw >> 8) % 4;
      const std::uint64_t sequence =
          backwards ? head - std::min(head - base, (draw >> 8) % 50) : head + step;
      ledger.advance_to(sequence, draw % 7 == 0);
      if (ledger.expects(sequence)) {
        if (draw % 11 == 0) {
          ledger.lose(LossCause::ring_full);
        } else {
          ledger.deliver();
        }
      }
      head = std::max(head, sequence + 1);
      ASSERT_TRUE(ledger.account().balanced());
      ASSERT_EQ(ledger.account().emitted, ledger.next().value() - base);
    }
    EXPECT_GT(ledger.account().lost.out_of_order, 0U);
  }
}

TEST(SequenceLedger, SurvivesTheLargestJump) {
  SequenceLedger ledger;
  arrive(ledger, 0);
  EXPECT_TRUE(arrive(ledger, std::numeric_limits<std::uint64_t>::max() - 1));
  EXPECT_TRUE(ledger.account().balanced());
}

}  // namespace
}  // namespace wobblebench::hw
