// Samples back to echo amplitudes, and streams that state their scale or do not.
#include "hw/wire/configuration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "hw/wire/stream_audit.h"
#include "hw/wire/unreadable_stream.h"
#include "tests/hw/support/streams.h"

namespace wobblebench::hw {
namespace {

constexpr DisplayScale kScale = {
    .full_scale_db = -20, .dynamic_range_db = 50, .tgc_db_per_cm_mhz = 0.5};

/// 4 MHz: TGC is 2 * 0.5 * 4 = 4 dB a centimetre.
AcquisitionPlan plan_at_4_mhz() {
  return {{.center_frequency_hz = 4e6}, {}};
}

double log_db(float sample, double range_m) {
  return echo_db(sample, SampleScale::log_compressed, kScale, plan_at_4_mhz(), range_m);
}

double linear_db(float sample, double range_m) {
  return echo_db(sample, SampleScale::linear_envelope, kScale, plan_at_4_mhz(), range_m);
}

TEST(DisplayScale, LogSamplesComeBackToDecibels) {
  EXPECT_DOUBLE_EQ(log_db(1, 0), -20);
  EXPECT_DOUBLE_EQ(log_db(0, 0), -70);
  EXPECT_DOUBLE_EQ(log_db(0.5F, 0), -45);
  EXPECT_DOUBLE_EQ(log_db(0.5F, 25e-3), -55) << "10 dB of TGC";
}

TEST(DisplayScale, LinearSamplesComeBackToDecibels) {
  EXPECT_DOUBLE_EQ(linear_db(1, 0), -20);
  EXPECT_DOUBLE_EQ(linear_db(100, 0), 20);
  EXPECT_DOUBLE_EQ(linear_db(10, 25e-3), -10);
  EXPECT_EQ(linear_db(0, 0), -std::numeric_limits<double>::infinity());
}

TEST(DisplayScale, GainIsAtMost600Decibels) {
  const DisplayScale steep = {
      .full_scale_db = -100, .dynamic_range_db = 60, .tgc_db_per_cm_mhz = 3};
  const AcquisitionPlan plan = plan_at_4_mhz();
  const auto of_one = [&](double range_m) {
    return echo_db(1, SampleScale::log_compressed, steep, plan, range_m);
  };
  EXPECT_NEAR(of_one(0.2), -100 - 24 * 20, 1e-9);
  EXPECT_DOUBLE_EQ(of_one(0.3), -600) << "24 dB a centimetre would be 720 dB";
}

TEST(DisplayScale, WithoutAScaleThereAreNoDecibels) {
  EXPECT_FALSE(DisplayScale().stated());
  EXPECT_THROW(echo_db(1, SampleScale::log_compressed, DisplayScale(), plan_at_4_mhz(), 0),
               std::invalid_argument);
}

TEST(DisplayScale, AnotherScaleIsAnotherStream) {
  const AcquisitionPlan plan = small_plan(2);
  ConfigurationPacket packet = configuration_of(plan, 0);
  packet.display_scale = kScale;
  StreamAudit audit;
  EXPECT_TRUE(audit.take(packet).accepted);
  EXPECT_TRUE(audit.configuration()->display_scale == kScale);
  EXPECT_FALSE(audit.take(packet).accepted);
  packet.display_scale.full_scale_db = -10;
  EXPECT_TRUE(audit.take(packet).accepted);
}

TEST(DisplayScale, AnImpossibleScaleEndsTheStream) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const DisplayScale& bad : {DisplayScale{.dynamic_range_db = 300},
                                  DisplayScale{.full_scale_db = -15},
                                  DisplayScale{.dynamic_range_db = 60, .tgc_db_per_cm_mhz = -1},
                                  DisplayScale{.dynamic_range_db = kNan}}) {
    ConfigurationPacket packet = configuration_of(small_plan(), 0);
    packet.display_scale = bad;
    EXPECT_THROW(StreamAudit().take(packet), UnreadableStream);
  }
}

}  // namespace
}  // namespace wobblebench::hw
