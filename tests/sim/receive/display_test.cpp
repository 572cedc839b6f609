// Lateral smoothing, frame averaging and quantisation of detected samples.
#include "sim/receive/display.h"

#include <gtest/gtest.h>

#include <vector>

namespace wobblebench::sim {
namespace {

/// Three lines of two samples in a frame, two frames.
const hw::AcquisitionPlan kPlan(
    {}, {.sticks_per_frame = 3, .samples_per_stick = 2, .frames_per_volume = 2});

std::vector<float> shown(std::vector<float> samples, const SimulationOptions& options) {
  show(samples, 2, kPlan, options);
  return samples;
}

void expect_near(const std::vector<float>& found, const std::vector<float>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-6) << i;
}

const std::vector<float> kTwoPoints{0, 0, 1, 0, 0, 0, /**/ 0, 0, 0, 0, 0, 1};

TEST(Display, IsOffByDefault) {
  EXPECT_FALSE(changes_samples({}));
  EXPECT_EQ(shown(kTwoPoints, {}), kTwoPoints);
}

/// The missing neighbour of an outermost line is the line itself.
TEST(Display, SmoothsAcrossLines) {
  SimulationOptions options;
  options.output = hw::SampleScale::linear_envelope;
  options.display.line_filter = 0.4;
  expect_near(shown(kTwoPoints, options), {0.2F, 0, 0.6F, 0, 0.2F, 0, /**/ 0, 0, 0, 0.2F, 0, 0.8F});
}

/// Black at -60 dB; what lies below -120 dB counts as -120 dB: 0.6 * 0 dB + 0.4 * -120 dB is -48
/// dB.
TEST(Display, SmoothsBeforeBlackClips) {
  SimulationOptions options;
  options.dynamic_range_db = 60;
  options.display.line_filter = 0.4;
  EXPECT_EQ(before_show(options).output, hw::SampleScale::linear_envelope);
  expect_near(shown({0, 1, 1, 1, 1e-9F, 1, /**/ 0, 0, 1e-3F, 0, 1e-3F, 100}, options),
              {0, 1, 0.2F, 1, 0, 1, /**/ 0, 0, 0, 0, 0, 1});
}

TEST(Display, AveragesWithTheFrameBefore) {
  SimulationOptions options;
  options.output = hw::SampleScale::linear_envelope;
  options.display.persistence = 0.25;
  expect_near(shown(kTwoPoints, options), {0, 0, 1, 0, 0, 0, /**/ 0, 0, 0.25F, 0, 0, 0.75F});
}

TEST(Display, QuantisesToGreyLevels) {
  SimulationOptions options;
  options.display.grey_bits = 2;  // 0, 1/3, 2/3, 1
  EXPECT_TRUE(changes_samples(options));
  expect_near(shown({0, 0.1F, 0.17F, 0.4F, 0.6F, 0.9F, 1, 0, 0, 0, 0, 0}, options),
              {0, 0, 1 / 3.0F, 1 / 3.0F, 2 / 3.0F, 1, 1, 0, 0, 0, 0, 0});
  options.output = hw::SampleScale::linear_envelope;
  EXPECT_FALSE(changes_samples(options));
}

}  // namespace
}  // namespace wobblebench::sim
