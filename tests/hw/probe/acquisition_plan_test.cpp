#include "hw/probe/acquisition_plan.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <sstream>
#include <string>

#include "base/options.h"
#include "tests/hw/support/streams.h"
#include "tests/support/expect.h"

namespace wobblebench::hw {
namespace {

AcquisitionPlan plan_of(const AcquisitionOptions& acquisition) {
  return {{}, acquisition};
}

AcquisitionOptions with_frames(int frames) {
  AcquisitionOptions acquisition;
  acquisition.frames_per_volume = frames;
  return acquisition;
}

TEST(AcquisitionPlan, VolumeDurationIsThePapers) {
  // 35 x 64 x 2 x 0.16 m / 1540 m/s = 0.46545454... s
  EXPECT_EQ(plan_of(with_frames(35)).volume_duration().count(), 465454545);
  EXPECT_EQ(plan_of(with_frames(37)).volume_duration().count(), 492051948);
}

TEST(AcquisitionPlan, StickTimesDoNotDrift) {
  const AcquisitionPlan plan = plan_of({});
  // 77 sticks take 77 x 0.32 / 1540 s = 16 ms exactly.
  for (const std::uint64_t n : {0ULL, 1ULL, 1000ULL, 1000000ULL, 1000000000ULL}) {
    EXPECT_EQ(plan.stick_time(77 * n).time_since_epoch().count(), 16000000LL * std::int64_t(n));
  }
  std::int64_t before = 0;
  for (std::uint64_t i = 1; i < 10000; ++i) {
    const std::int64_t now = plan.stick_time(i).time_since_epoch().count();
    EXPECT_TRUE(now - before == 207792 || now - before == 207793) << i;
    before = now;
  }
}

TEST(AcquisitionPlan, TimesAreRoundedOnce) {
  // A stick takes 16e6 / 77 ns. Near a tie the rounding of 0.16 itself to a double may show.
  const AcquisitionPlan plan = plan_of({});
  for (std::uint64_t i = 0; i < 10000; ++i) {
    const std::uint64_t sequence = hash(1, i) % 10000000000;
    const std::uint64_t over = sequence * 16000000 % 77;
    if (over >= 31 && over <= 46) continue;
    const std::uint64_t nearest = sequence * 16000000 / 77 + (over > 38 ? 1 : 0);
    ASSERT_EQ(plan.stick_time(sequence).time_since_epoch().count(), std::int64_t(nearest));
  }
}

TEST(AcquisitionPlan, AddsDeadTimeToEveryStick) {
  AcquisitionOptions acquisition;
  acquisition.depth_m = 0.077;
  acquisition.dead_time_s = 12.5e-6;
  const AcquisitionPlan plan = plan_of(acquisition);
  EXPECT_DOUBLE_EQ(plan.stick_period_s(), 112.5e-6);
  EXPECT_EQ(plan.stick_time(1000001).time_since_epoch().count(), 112500112500);
}

TEST(AcquisitionPlan, TimeSaturatesAtTheEndOfTheClock) {
  const DeviceTime end = plan_of({}).stick_time(std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(end.time_since_epoch(), DeviceDuration::max());
}

TEST(AcquisitionPlan, AnglesAreEquallySpacedBetweenTheEdges) {
  const AcquisitionPlan plan = plan_of({});
  EXPECT_DOUBLE_EQ(plan.theta_rad(0), -38.5 * kDegree);
  EXPECT_DOUBLE_EQ(plan.theta_rad(63), 38.5 * kDegree);
  EXPECT_DOUBLE_EQ(plan.frame_phi_rad(0), -30.5 * kDegree);
  EXPECT_DOUBLE_EQ(plan.frame_phi_rad(36), 30.5 * kDegree);
  EXPECT_NEAR(plan.frame_phi_rad(18), 0, 1e-16);
  EXPECT_DOUBLE_EQ(plan.theta_step_rad(), 77 * kDegree / 63);
  for (int line = 1; line < 64; ++line) {
    EXPECT_NEAR(plan.theta_rad(line) - plan.theta_rad(line - 1), plan.theta_step_rad(), 1e-15);
  }
  EXPECT_EQ(plan.theta_rad(10), -plan.theta_rad(53));
}

TEST(AcquisitionPlan, SingleLineAndSingleFrameHaveAngleZero) {
  AcquisitionOptions acquisition = with_frames(1);
  acquisition.sticks_per_frame = 1;
  acquisition.motor = MotorMode::continuous;
  const AcquisitionPlan plan = plan_of(acquisition);
  EXPECT_EQ(plan.theta_rad(0), 0);
  EXPECT_EQ(plan.motor_angle_rad({0, 0, 0}), 0);
  EXPECT_EQ(plan.theta_step_rad(), 0);
  EXPECT_EQ(plan.phi_step_rad(), 0);
}

TEST(AcquisitionPlan, SamplesAreAtTheCentreOfTheirRange) {
  const AcquisitionPlan plan = plan_of({});
  EXPECT_DOUBLE_EQ(plan.sample_spacing_m(), 0.16 / 512);
  EXPECT_DOUBLE_EQ(plan.sample_range_m(0), 0.08 / 512);
  EXPECT_DOUBLE_EQ(plan.sample_range_m(511), 0.16 - 0.08 / 512);
}

/// Sets one described field just outside one of its limits, and holds the expected message.
struct OutOfRangeVisitor {
  int target;
  bool above;
  int field = 0;
  std::string expected;

  void real(std::string_view key, double& value, double unit, double min, double max) {
    if (field++ != target) return;
    value = (above ? max * 1.001 : min - 0.001) * unit;
    expect_message(key, min, max);
  }
  void integer(std::string_view key, int& value, int min, int max) {
    if (field++ != target) return;
    value = above ? max + 1 : min - 1;
    expect_message(key, min, max);
  }
  template <class Enum>
  void choice(std::string_view, Enum&, std::initializer_list<std::pair<std::string_view, Enum>>) {}
  void expect_message(std::string_view key, double min, double max) {
    std::ostringstream text;
    text << key << " = |: must be within " << min << " and " << max;
    expected = text.str();
  }
};

TEST(AcquisitionOptions, RejectsEveryFieldOutOfRange) {
  std::set<std::string> keys;
  for (int target = 0; target < 11; ++target) {
    for (const bool above : {false, true}) {
      AcquisitionOptions acquisition;
      OutOfRangeVisitor visitor{target, above};
      describe(acquisition, visitor);
      ASSERT_EQ(visitor.field, 11);
      const std::string message = refusal_of<InvalidOption>([&] { plan_of(acquisition); });
      const auto bar = visitor.expected.find('|');
      EXPECT_TRUE(message.starts_with(visitor.expected.substr(0, bar))) << message;
      EXPECT_TRUE(message.ends_with(visitor.expected.substr(bar + 1))) << message;
      keys.insert(message.substr(0, message.find(' ')));
    }
  }
  EXPECT_EQ(keys.size(), 11U);
}

TEST(AcquisitionOptions, DefaultsPassAndLimitsAreInclusive) {
  EXPECT_NO_THROW(plan_of({}));
  AcquisitionOptions acquisition;
  acquisition.depth_m = 400 * kMillimetre;
  acquisition.sector_rad = 170 * kDegree;
  acquisition.dead_time_s = 10000 * kMicrosecond;
  EXPECT_NO_THROW(plan_of(acquisition));
}

TEST(AcquisitionPlan, AStickTakesAnEchoTimeForEachOfItsZones) {
  AcquisitionOptions acquisition;
  acquisition.dead_time_s = 3e-6;
  acquisition.focal_zones = 4;
  const AcquisitionPlan plan({}, acquisition);
  // 2 * 160 mm / 1540 m/s, four times.
  EXPECT_NEAR(plan.stick_period_s(), 4 * 207.792208e-6 + 3e-6, 1e-11);
  const AcquisitionPlan received({}, with_one_zone(acquisition));
  EXPECT_EQ(received.acquisition().focal_zones, 1);
  for (const std::uint64_t sequence : {0ull, 1ull, 777ull, 2368ull, 1000000007ull}) {
    EXPECT_EQ(plan.stick_time(sequence), received.stick_time(sequence)) << sequence;
  }
  acquisition.depth_m = 0.4;
  acquisition.dead_time_s = 9e-3;
  EXPECT_THROW(AcquisitionPlan({}, acquisition), InvalidOption);
}

}  // namespace
}  // namespace wobblebench::hw
