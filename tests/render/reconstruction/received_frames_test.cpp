#include "render/reconstruction/received_frames.h"

#include <gtest/gtest.h>

#include <limits>

namespace wobblebench::render {
namespace {

hw::AcquisitionPlan plan_of(int lines) {
  hw::AcquisitionOptions scan;
  scan.frames_per_volume = 2;
  scan.sticks_per_frame = lines;
  scan.samples_per_stick = 2;
  return {hw::ProbeOptions{}, scan};
}

/// Stick l holds l / 10, those that did not arrive zeros.
hw::PolarFrame ramp(const std::vector<std::uint8_t>& arrived) {
  hw::PolarFrame frame;
  frame.arrived = arrived;
  for (std::size_t l = 0; l < arrived.size(); ++l) {
    frame.samples.insert(frame.samples.end(), 2, arrived[l] ? 0.1f * float(l) : 0.0f);
  }
  return frame;
}

TEST(ReceivedFrames, ALostStickIsTheMeanOfTheNearestThatArrivedByDistance) {
  ReceivedFrames frames(plan_of(7));
  frames.put(0, ramp({1, 0, 1, 0, 0, 1, 1}));
  for (std::size_t l = 0; l < 7; ++l) {
    EXPECT_NEAR(frames.frames()[0][2 * l], 0.1 * double(l), 1e-6) << l;
  }
}

TEST(ReceivedFrames, BeyondTheLastOnesItIsTheNearest) {
  ReceivedFrames frames(plan_of(5));
  frames.put(0, ramp({0, 0, 1, 1, 0}));
  EXPECT_FLOAT_EQ(frames.frames()[0][0], 0.2f);
  EXPECT_FLOAT_EQ(frames.frames()[0][2], 0.2f);
  EXPECT_FLOAT_EQ(frames.frames()[0][8], 0.3f);
}

TEST(ReceivedFrames, AFrameWithoutSticksIsEmpty) {
  ReceivedFrames frames(plan_of(3));
  frames.put(0, ramp({0, 0, 0}));
  for (const float sample : frames.frames()[0]) EXPECT_EQ(sample, 0);
}

TEST(ReceivedFrames, CleansSamplesAndCountsFrames) {
  ReceivedFrames frames(plan_of(2));
  hw::PolarFrame frame = ramp({1, 1});
  frame.samples = {std::numeric_limits<float>::quiet_NaN(), 2, -1, 0.5f};
  frames.put(0, frame);
  EXPECT_EQ(frames.frames()[0], (std::vector<float>{0, 1, 0, 0.5f}));
  EXPECT_FALSE(frames.volume_complete());
  frames.put(1, frame);
  EXPECT_TRUE(frames.volume_complete());
  frames.begin_volume();
  EXPECT_FALSE(frames.volume_complete());
}

TEST(ReceivedFrames, RefusesAFrameOutsideThePlanOrOfAnotherSize) {
  ReceivedFrames frames(plan_of(2));
  EXPECT_THROW(frames.put(2, ramp({1, 1})), std::out_of_range);
  EXPECT_THROW(frames.put(-1, ramp({1, 1})), std::out_of_range);
  EXPECT_THROW(frames.put(0, ramp({1})), std::invalid_argument);
}

}  // namespace
}  // namespace wobblebench::render
