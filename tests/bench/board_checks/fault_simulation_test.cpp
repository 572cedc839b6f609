#include "bench/board_checks/fault_simulation/fault_simulation.h"

#include <gtest/gtest.h>

#include "bench/board_checks/fault_simulation/oracle.h"
#include "bench/board_checks/fault_simulation/scenario.h"
#include "bench/pipeline/stick_sources.h"
#include "hw/board/ring.h"
#include "hw/wire/packet.h"

namespace wobblebench::bench {
namespace {

TEST(FaultSimulation, AThousandSeedsKeepTheRulesAndRepeatExactly) {
  hw::BoardAccount account;
  std::uint64_t salvaged = 0, recorded = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    const FaultSimulationResult result = simulate_faults(seed);
    ASSERT_EQ(result.failure, "") << "wobblebench rehearse --seeds 1 --trace --first-seed " << seed;
    ASSERT_EQ(simulate_faults(seed).hash, result.hash) << seed;
    account.delivered += result.account.delivered;
    account.lost.ring_full += result.account.lost.ring_full;
    account.lost.link += result.account.lost.link;
    account.lost.corrupt += result.account.lost.corrupt;
    account.lost.out_of_order += result.account.lost.out_of_order;
    account.duplicates += result.account.duplicates;
    salvaged += result.sticks_salvaged;
    recorded += result.bytes_recorded;
  }
  // Every kind of loss has to occur, or the rules were not tested.
  EXPECT_GT(account.delivered, 50000U);
  EXPECT_GT(account.lost.ring_full, 1000U);
  EXPECT_GT(account.lost.link, 1000U);
  EXPECT_GT(account.lost.corrupt, 500U);
  EXPECT_GT(account.lost.out_of_order, 500U);
  EXPECT_GT(account.duplicates, 500U);
  EXPECT_GT(salvaged, 20000U);
  EXPECT_GT(recorded, 5000000U);
}

TEST(FaultSimulation, AnotherSeedGivesAnotherHash) {
  EXPECT_NE(simulate_faults(1).hash, simulate_faults(2).hash);
}

TEST(FaultSimulation, TheTraceHasALineForEachStick) {
  std::size_t sticks = 0;
  std::uint64_t seed = 1;
  while (draw_scenario(seed).assemble_volumes) ++seed;
  const auto result =
      simulate_faults(seed, [&](const std::string& line) { sticks += line.starts_with("stick "); });
  EXPECT_EQ(sticks, result.account.delivered);
}

class OracleOfTwoSticks : public testing::Test {
 protected:
  OracleOfTwoSticks() : scenario_{.plan = plan()}, oracle_(scenario_, {}) {
    receive(hw::Configuration{scenario_.plan, hw::StreamOrigin::simulated});
  }
  static hw::AcquisitionPlan plan() {
    hw::AcquisitionOptions acquisition;
    acquisition.samples_per_stick = 4;
    return {{}, acquisition};
  }
  hw::Stick stick(std::uint64_t sequence) const {
    hw::Stick made{.sequence = sequence,
                   .index = scenario_.plan.index(sequence),
                   .time = scenario_.plan.stick_time(sequence)};
    for (std::uint32_t k = 0; k < 4; ++k) {
      made.samples.push_back(synthetic_sample(scenario_.seed, sequence, k));
    }
    return made;
  }
  void receive(const hw::Event& event) { EXPECT_TRUE(oracle_.check_event(event)); }
  void give(const hw::Stick& given) {
    auto ring = std::make_shared<hw::StickRing>(1);
    hw::Stick* slot = ring->acquire();
    *slot = given;
    receive(hw::StickSlot(ring, slot));
  }

  Scenario scenario_;
  Oracle oracle_;
};

TEST_F(OracleOfTwoSticks, AcceptsSticksInOrder) {
  EXPECT_NO_THROW(give(stick(0)));
  EXPECT_NO_THROW(give(stick(1)));
}

TEST_F(OracleOfTwoSticks, RefusesARepeatedAMissingAndAChangedStick) {
  give(stick(0));
  EXPECT_THROW(give(stick(0)), RuleViolation);
  EXPECT_THROW(give(stick(2)), RuleViolation);
  hw::Stick changed = stick(1);
  changed.samples[2] += 1e-6F;
  EXPECT_THROW(give(changed), RuleViolation);
}

TEST_F(OracleOfTwoSticks, RefusesALossWithoutACause) {
  give(stick(0));
  receive(hw::Gap{1, 2, hw::LossCause::link});
  const hw::FaultEvent hit{hw::FaultKind::drop, 2, hw::PacketKind::stick, 1};
  EXPECT_THROW(oracle_.check_losses({hit}, 0), RuleViolation);
  const hw::FaultEvent also{hw::FaultKind::drop, 3, hw::PacketKind::stick, 2};
  EXPECT_NO_THROW(oracle_.check_losses({hit, also}, 0));
  EXPECT_THROW(oracle_.check_account({.emitted = 3, .delivered = 2}), RuleViolation);
}

}  // namespace
}  // namespace wobblebench::bench
