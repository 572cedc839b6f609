#include "bench/checks/fault_simulation/fault_simulation.h"

#include <gtest/gtest.h>

#include "bench/checks/fault_simulation/oracle.h"
#include "bench/checks/fault_simulation/scenario.h"
#include "bench/pipeline/synthetic_sticks.h"
#include "hw/board/ring.h"
#include "hw/wire/packet.h"

namespace wobblebench::bench {
namespace {

TEST(FaultSimulation, AThousandSeedsHoldTheRulesAndPlayTheSameTwice) {
  hw::BoardAccount account;
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
  }
  // It would prove little if nothing went wrong.
  EXPECT_GT(account.delivered, 50000U);
  EXPECT_GT(account.lost.ring_full, 1000U);
  EXPECT_GT(account.lost.link, 1000U);
  EXPECT_GT(account.lost.corrupt, 500U);
  EXPECT_GT(account.lost.out_of_order, 500U);
  EXPECT_GT(account.duplicates, 500U);
}

TEST(FaultSimulation, AnotherSeedIsAnotherPlay) {
  EXPECT_NE(simulate_faults(1).hash, simulate_faults(2).hash);
}

TEST(FaultSimulation, ItsTraceTellsWhatHappened) {
  std::size_t sticks = 0;
  std::uint64_t seed = 1;
  while (draw_scenario(seed).into_volumes) ++seed;
  const auto result =
      simulate_faults(seed, [&](const std::string& line) { sticks += line.starts_with("stick "); });
  EXPECT_EQ(sticks, result.account.delivered);
}

class OracleOfTwoSticks : public testing::Test {
 protected:
  OracleOfTwoSticks() : scenario_{.plan = plan()}, oracle_(scenario_, {}) {
    oracle_.event(hw::Configuration{scenario_.plan, hw::StreamOrigin::simulated});
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
  void give(const hw::Stick& given) {
    auto ring = std::make_shared<hw::StickRing>(1);
    hw::Stick* slot = ring->acquire();
    *slot = given;
    oracle_.event(hw::StickSlot(ring, slot));
  }

  Scenario scenario_;
  Oracle oracle_;
};

TEST_F(OracleOfTwoSticks, AcceptsThemInOrder) {
  EXPECT_NO_THROW(give(stick(0)));
  EXPECT_NO_THROW(give(stick(1)));
}

TEST_F(OracleOfTwoSticks, SeesARepeatAHoleAndAForgery) {
  give(stick(0));
  EXPECT_THROW(give(stick(0)), RuleBroken);
  EXPECT_THROW(give(stick(2)), RuleBroken);
  hw::Stick forged = stick(1);
  forged.samples[2] += 1e-6F;
  EXPECT_THROW(give(forged), RuleBroken);
}

TEST_F(OracleOfTwoSticks, SeesALossThatNothingExplains) {
  give(stick(0));
  oracle_.event(hw::Gap{1, 2, hw::LossCause::link});
  const hw::FaultEvent struck{hw::FaultKind::drop, 2, hw::PacketKind::stick, 1};
  EXPECT_THROW(oracle_.explain({struck}, 0), RuleBroken);
  const hw::FaultEvent also{hw::FaultKind::drop, 3, hw::PacketKind::stick, 2};
  EXPECT_NO_THROW(oracle_.explain({struck, also}, 0));
  EXPECT_THROW(oracle_.account({.emitted = 3, .delivered = 2}), RuleBroken);
}

}  // namespace
}  // namespace wobblebench::bench
