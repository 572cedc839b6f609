#include "hw/probe/polar_volume.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/hw/support/streams.h"

namespace wobblebench::hw {
namespace {

TEST(PolarVolume, IsEmptyAtFirst) {
  const AcquisitionPlan plan = small_plan();
  const PolarVolume volume(plan);
  EXPECT_EQ(volume.missing_sticks(), 12);
  ASSERT_EQ(volume.frames().size(), 3U);
  for (int f = 0; f < 3; ++f) {
    const PolarFrame& frame = volume.frame(f);
    EXPECT_EQ(frame.samples, std::vector<float>(20, 0.0F));
    EXPECT_EQ(frame.motor_angle_rad, std::vector<double>(4, plan.frame_phi_rad(f)));
  }
}

TEST(PolarVolume, StoresEveryStickAtItsIndex) {
  const AcquisitionPlan plan = small_plan();
  PolarVolume volume(plan, 1);
  for (std::uint64_t i = 0; i < 12; ++i) {
    Stick stick = test_stick(plan, 12 + i);
    stick.motor_angle_rad += 0.001;
    stick.scale = SampleScale::linear_envelope;
    volume.place(stick);
    EXPECT_EQ(volume.missing_sticks(), 11 - static_cast<int>(i));
    const PolarFrame& frame = volume.frame(static_cast<int>(i / 4));
    const auto line = static_cast<std::ptrdiff_t>(i % 4);
    EXPECT_TRUE(
        std::equal(stick.samples.begin(), stick.samples.end(), frame.samples.begin() + 5 * line));
    EXPECT_EQ(frame.motor_angle_rad[i % 4], stick.motor_angle_rad);
    EXPECT_EQ(frame.arrived[i % 4], 1);
  }
  EXPECT_EQ(volume.scale(), SampleScale::linear_envelope);
  EXPECT_EQ(volume.volume_index(), 1U);
}

TEST(PolarVolume, RejectsInvalidSticksAndIsUnchanged) {
  const AcquisitionPlan plan = small_plan();
  PolarVolume volume(plan);
  Stick stick = test_stick(plan, 0);
  stick.index.line = 4;
  EXPECT_THROW(volume.place(stick), std::out_of_range);
  stick.index = {0, 3, 0};
  EXPECT_THROW(volume.place(stick), std::out_of_range);
  stick.index = {1, 0, 0};
  EXPECT_THROW(volume.place(stick), std::out_of_range) << "of another volume";
  stick.index = {0, 0, 0};
  stick.samples.push_back(0);
  EXPECT_THROW(volume.place(stick), std::invalid_argument);
  EXPECT_EQ(volume.missing_sticks(), 12);
}

TEST(PolarVolume, HoldsTheSamplesThatItIsMadeOf) {
  const AcquisitionPlan plan = small_plan(2, MotorMode::alternating);
  PolarVolume placed(plan, 1);
  std::vector<float> samples;
  for (std::uint64_t sequence = 12; sequence < 24; ++sequence) {
    const Stick stick = test_stick(plan, sequence);
    placed.place(stick);
    samples.insert(samples.end(), stick.samples.begin(), stick.samples.end());
  }
  const auto made = PolarVolume::of_samples(plan, 1, SampleScale::linear_envelope, samples);
  EXPECT_EQ(made.volume_index(), 1U);
  EXPECT_EQ(made.scale(), SampleScale::linear_envelope);
  EXPECT_EQ(made.missing_sticks(), 0);
  for (int frame = 0; frame < 3; ++frame) {
    EXPECT_EQ(made.frame(frame).samples, placed.frame(frame).samples);
    EXPECT_EQ(made.frame(frame).motor_angle_rad, placed.frame(frame).motor_angle_rad);
  }
}

TEST(PolarVolume, LogCompressesLinearEnvelopes) {
  const AcquisitionPlan plan = small_plan();
  PolarVolume volume(plan);
  Stick stick = test_stick(plan, 0);
  stick.scale = SampleScale::linear_envelope;
  // Full scale, 10 dB and 20 dB below it, below the range of 40 dB, and above full scale.
  stick.samples = {1.0F, 0.31622777F, 0.1F, 1e-3F, 3.0F};
  volume.place(stick);
  volume.log_compress(40);
  const std::vector<float>& samples = volume.frame(0).samples;
  const float expected[] = {1, 0.75F, 0.5F, 0, 1, 0};  // the last is of a stick that is missing
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(samples[k], expected[k], 1e-6) << k;
  EXPECT_EQ(volume.scale(), SampleScale::log_compressed);
  volume.log_compress(40);
  EXPECT_NEAR(volume.frame(0).samples[1], 0.75F, 1e-6) << "once only";
}

}  // namespace
}  // namespace wobblebench::hw
