// Order, angle and time of sticks in each motor mode.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "hw/board/volume_assembly.h"
#include "tests/hw/support/collect.h"
#include "tests/hw/support/memory_link.h"
#include "tests/hw/support/streams.h"

namespace wobblebench::hw {
namespace {

AcquisitionPlan default_plan(MotorMode motor) {
  AcquisitionOptions acquisition;
  acquisition.motor = motor;
  return {{}, acquisition};
}

AcquisitionPlan odd_plan(MotorMode motor, std::uint64_t seed) {
  AcquisitionOptions acquisition;
  acquisition.frames_per_volume = static_cast<int>(1 + hash(seed, 0) % 50);
  acquisition.sticks_per_frame = static_cast<int>(1 + hash(seed, 1) % 50);
  acquisition.dead_time_s = uniform(seed, 2, 0, 1e-3);
  acquisition.fly_back_s = uniform(seed, 3, 0, 1);
  acquisition.motor = motor;
  return {{}, acquisition};
}

class EveryMotorMode : public testing::TestWithParam<MotorMode> {};

TEST_P(EveryMotorMode, IndexAndSequenceAreInverse) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const AcquisitionPlan plan = odd_plan(GetParam(), seed);
    for (std::uint64_t i = 0; i < 3000; ++i) {
      const std::uint64_t sequence = i < 1000 ? i : hash(seed, i) % 1000000000;
      ASSERT_EQ(plan.sequence(plan.index(sequence)), sequence);
    }
  }
}

TEST_P(EveryMotorMode, EveryVolumeHasEveryFrameAndLineOnce) {
  const AcquisitionPlan plan = small_plan(4, GetParam());
  for (std::uint32_t volume = 0; volume < 4; ++volume) {
    std::set<std::tuple<std::uint32_t, std::uint32_t>> sticks;
    for (std::uint64_t i = 0; i < 12; ++i) {
      const StickIndex index = plan.index(plan.first_sequence(volume) + i);
      ASSERT_EQ(index.volume, volume);
      ASSERT_EQ(index.line, i % 4) << "lines of a frame are acquired in increasing order";
      sticks.insert({index.frame, index.line});
    }
    EXPECT_EQ(sticks.size(), 12U);
    EXPECT_EQ(std::get<0>(*sticks.rbegin()), 2U);
  }
}

TEST_P(EveryMotorMode, MotorAngleFollowsTheSweepDirection) {
  const AcquisitionPlan plan = default_plan(GetParam());
  const bool turns = GetParam() != MotorMode::stepped;
  const auto sticks = static_cast<std::uint64_t>(plan.sticks_per_volume());
  for (std::uint32_t volume = 0; volume < 3; ++volume) {
    const int direction = plan.sweep_direction(volume);
    EXPECT_EQ(direction, GetParam() == MotorMode::alternating && volume == 1 ? -1 : 1);
    for (std::uint64_t i = 1; i < sticks; ++i) {
      const std::uint64_t sequence = plan.first_sequence(volume) + i;
      const double turned_rad = plan.motor_angle_rad(plan.index(sequence)) -
                                plan.motor_angle_rad(plan.index(sequence - 1));
      const double rests_rad = i % 64 == 0 ? plan.phi_step_rad() : 0;
      const double expected_rad = turns ? direction * plan.phi_step_rad() / 64 : rests_rad;
      ASSERT_NEAR(turned_rad, expected_rad, 1e-15);
    }
  }
}

TEST_P(EveryMotorMode, FrameHasItsPlaneInEveryVolume) {
  const AcquisitionPlan plan = default_plan(GetParam());
  for (std::uint32_t volume = 0; volume < 3; ++volume) {
    for (std::uint32_t frame = 0; frame < 37; ++frame) {
      const double before_rad = plan.motor_angle_rad({volume, frame, 31});
      const double after_rad = plan.motor_angle_rad({volume, frame, 32});
      ASSERT_NEAR((before_rad + after_rad) / 2, plan.frame_phi_rad(static_cast<int>(frame)), 1e-15);
      ASSERT_LE(std::abs(after_rad - before_rad), plan.phi_step_rad() / 64 * 1.0001);
    }
  }
}

TEST_P(EveryMotorMode, SingleStickHasAngleZero) {
  AcquisitionOptions acquisition;
  acquisition.frames_per_volume = 1;
  acquisition.sticks_per_frame = 1;
  acquisition.motor = GetParam();
  const AcquisitionPlan plan({}, acquisition);
  EXPECT_EQ(plan.motor_angle_rad({0, 0, 0}), 0);
  EXPECT_EQ(plan.motor_angle_rad({1, 0, 0}), 0);
  EXPECT_EQ(plan.sequence({3, 0, 0}), 3U);
}

TEST_P(EveryMotorMode, OnlyFlyBackTakesTime) {
  const AcquisitionPlan plan = default_plan(GetParam());
  // 77 sticks take 16 ms exactly; a volume is 2368 of them, 77 volumes then take 2368 x 16 ms.
  const std::int64_t return_ns = GetParam() == MotorMode::fly_back ? 50000000 : 0;
  for (const std::int64_t times : {0, 1, 2, 1000, 10000}) {
    const auto volume = static_cast<std::uint32_t>(77 * times);
    const std::int64_t first_ns = times * (2368LL * 16000000 + 77 * return_ns);
    EXPECT_EQ(plan.stick_time(plan.first_sequence(volume)).time_since_epoch().count(), first_ns);
    if (times == 0) continue;
    EXPECT_EQ(plan.volume_end_time(volume - 1).time_since_epoch().count(), first_ns - return_ns);
  }
  EXPECT_EQ(plan.volume_duration().count(), 492051948 + return_ns);
}

TEST_P(EveryMotorMode, TimeIncreasesByOnePeriod) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const AcquisitionPlan plan = odd_plan(GetParam(), seed);
    const bool returns = GetParam() == MotorMode::fly_back;
    const double period_ns = plan.stick_period_s() * 1e9;
    const double return_ns = returns ? plan.acquisition().fly_back_s * 1e9 : 0;
    const auto sticks = static_cast<std::uint64_t>(plan.sticks_per_volume());
    for (std::uint64_t i = 1; i < 5000; ++i) {
      const auto step = plan.stick_time(i) - plan.stick_time(i - 1);
      const double expected_ns = period_ns + (i % sticks == 0 ? return_ns : 0);
      ASSERT_NEAR(static_cast<double>(step.count()), expected_ns, 1.0001);
    }
  }
}

TEST_P(EveryMotorMode, NearestStickIsNearestInAngle) {
  const AcquisitionPlan plan = default_plan(GetParam());
  for (std::uint64_t i = 0; i < 10000; ++i) {
    const PolarPoint point{0.1, uniform(1, i, -0.8, 0.8), uniform(2, i, -0.7, 0.7)};
    const StickIndex stick = plan.nearest_stick(point, 5);
    ASSERT_EQ(stick.volume, 5U);
    const double half = 0.5000001;
    const double off_theta =
        std::abs(plan.theta_rad(static_cast<int>(stick.line)) - point.theta_rad);
    const double off_phi =
        std::abs(plan.frame_phi_rad(static_cast<int>(stick.frame)) - point.phi_rad);
    if (std::abs(point.theta_rad) < 38.5 * kDegree) {
      ASSERT_LE(off_theta, half * plan.theta_step_rad());
    } else {
      ASSERT_EQ(stick.line, point.theta_rad < 0 ? 0U : 63U);
    }
    if (std::abs(point.phi_rad) < 30.5 * kDegree) {
      ASSERT_LE(off_phi, half * plan.phi_step_rad());
    } else {
      ASSERT_EQ(stick.frame, point.phi_rad < 0 ? 0U : 36U);
    }
  }
}

TEST_P(EveryMotorMode, BoardDeliversCompleteVolumes) {
  const AcquisitionPlan plan = small_plan(4, GetParam());
  Board board(std::make_unique<MemoryLink>(stream_of(plan), MemoryLinkOptions{.chunk_seed = 7}));
  board.start();
  Collected seen;
  EXPECT_TRUE(std::holds_alternative<EndOfStream>(collect(board, seen)));
  ASSERT_EQ(seen.sticks.size(), 48U);
  for (std::uint64_t i = 0; i < 48; ++i) ASSERT_TRUE(is_genuine(plan, seen.sticks[i]));
  ASSERT_EQ(seen.ends.size(), 4U);
  for (std::uint32_t volume = 0; volume < 4; ++volume) {
    EXPECT_EQ(seen.ends[volume].volume, volume);
    EXPECT_EQ(seen.ends[volume].time, plan.volume_end_time(volume));
  }
  EXPECT_EQ(board.account().delivered, 48U);
  EXPECT_EQ(board.account().lost.total(), 0U);
  EXPECT_TRUE(seen.gaps.empty());
}

TEST_P(EveryMotorMode, AssemblyStoresEveryStickAtItsIndex) {
  const AcquisitionPlan plan = small_plan(2, GetParam());
  auto packets = packets_of(plan);
  packets[packet_index(plan, 13)] = {};  // the second stick of the second volume
  Board board(std::make_unique<MemoryLink>(join(packets)));
  board.start();
  VolumeAssembly assembly(board);
  for (std::uint32_t v = 0; v < 2; ++v) {
    const auto volume = assembly.next(patience());
    ASSERT_TRUE(volume);
    EXPECT_EQ(volume->volume_index(), v);
    for (std::uint32_t f = 0; f < 3; ++f) {
      const PolarFrame& frame = volume->frame(static_cast<int>(f));
      for (std::uint32_t l = 0; l < 4; ++l) {
        const std::uint64_t sequence = plan.sequence({v, f, l});
        ASSERT_EQ(frame.arrived[l], sequence != 13) << v << " " << f << " " << l;
        // The plan's angle where the stick is lost, as well.
        ASSERT_EQ(frame.motor_angle_rad[l], plan.motor_angle_rad({v, f, l}));
        if (sequence == 13) continue;
        ASSERT_EQ(frame.samples[5 * l], test_stick(plan, sequence).samples[0]);
      }
    }
  }
  EXPECT_EQ(board.account().lost.total(), 1U);
}

std::string name_of(const testing::TestParamInfo<MotorMode>& test) {
  return std::vector{"stepped", "continuous", "alternating", "fly_back"}.at(test.index);
}

INSTANTIATE_TEST_SUITE_P(Motor, EveryMotorMode, testing::ValuesIn(kMotorModes), name_of);

TEST(AlternatingMotor, DoesNotMoveBetweenVolumes) {
  const AcquisitionPlan plan = default_plan(MotorMode::alternating);
  EXPECT_EQ(plan.index(2368), (StickIndex{1, 36, 0}));
  EXPECT_EQ(plan.index(2 * 2368 - 1), (StickIndex{1, 0, 63}));
  EXPECT_EQ(plan.index(2 * 2368), (StickIndex{2, 0, 0}));
  // From the last stick of a volume to the first of the next the motor does not move.
  EXPECT_EQ(plan.motor_angle_rad({0, 36, 63}), plan.motor_angle_rad({1, 36, 0}));
  EXPECT_EQ(plan.motor_angle_rad({1, 0, 63}), plan.motor_angle_rad({2, 0, 0}));
}

TEST(AlternatingMotor, LostFrameOfABackwardSweepIsOneGap) {
  const AcquisitionPlan plan = small_plan(2, MotorMode::alternating);
  auto packets = packets_of(plan);
  for (std::uint64_t i = 16; i < 20; ++i) packets[packet_index(plan, i)] = {};
  Board board(std::make_unique<MemoryLink>(join(packets)));
  board.start();
  Collected seen;
  collect(board, seen);
  ASSERT_EQ(seen.gaps.size(), 1U);
  EXPECT_EQ(seen.gaps[0].first_sequence, 16U);
  EXPECT_EQ(seen.gaps[0].count, 4U);
  EXPECT_EQ(plan.index(16).frame, 1U);
  EXPECT_EQ(board.account().lost.link, 4U);
  EXPECT_EQ(seen.ends.size(), 2U);
}

TEST(AlternatingMotor, StickWithAReversedFrameIndexIsCorrupt) {
  const AcquisitionPlan plan = small_plan(2, MotorMode::alternating);
  auto packets = packets_of(plan);
  Stick stick = test_stick(plan, 14);
  EXPECT_EQ(stick.index.frame, 2U);
  stick.index.frame = 0;
  Bytes& packet = packets[packet_index(plan, 14)];
  packet.clear();
  encode(stick, packet);
  Board board(std::make_unique<MemoryLink>(join(packets)));
  board.start();
  Collected seen;
  collect(board, seen);
  EXPECT_EQ(seen.sticks.size(), 23U);
  EXPECT_EQ(board.account().lost.corrupt, 1U);
}

}  // namespace
}  // namespace wobblebench::hw
