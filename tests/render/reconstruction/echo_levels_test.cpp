#include "render/reconstruction/echo_levels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace wobblebench::render {
namespace {

/// Samples 0.3 mm apart.
hw::AcquisitionPlan plan() {
  hw::AcquisitionOptions scan;
  scan.frames_per_volume = 8;
  scan.sticks_per_frame = 16;
  return {hw::ProbeOptions{}, scan};
}

EchoLevels levels_of(const std::function<double(int sample)>& value) {
  const hw::AcquisitionOptions scan = plan().acquisition();
  std::vector<std::vector<float>> frames(8);
  for (auto& frame : frames) {
    for (int i = 0; i < scan.sticks_per_frame * scan.samples_per_stick; ++i) {
      frame.push_back(static_cast<float>(value(i % scan.samples_per_stick)));
    }
  }
  const std::vector<SampleSpan> spans(std::size_t{8} * 16, {0, scan.samples_per_stick});
  return measure_levels(plan(), frames, spans);
}

/// Log-compressed speckle: 10 log10 of a unit exponential over 60 dB.
class Speckle {
 public:
  double operator()(double level) {
    const double power = -std::log(1 - uniform_(random_));
    return std::clamp(level + 10 * std::log10(power) / 60, 0.0, 1.0);
  }

 private:
  std::mt19937 random_{7};
  std::uniform_real_distribution<double> uniform_{0, 1 - 1e-9};
};

TEST(EchoLevels, AreTheMeansOfTheTwoKinds) {
  const EchoLevels levels = levels_of([](int k) { return k < 300 ? 0.1 : 0.7; });
  EXPECT_TRUE(levels.separate);
  EXPECT_NEAR(levels.fluid, 0.1, 0.003);  // half a bin, and samples averaged across the edge
  EXPECT_NEAR(levels.tissue, 0.7, 0.003);
  EXPECT_NEAR(levels.at(0.5), 0.4, 0.003);
  EXPECT_EQ(levels.white, 0);
}

TEST(EchoLevels, CountWhiteSamplesOfTissue) {
  const EchoLevels levels = levels_of([](int k) { return k < 300 ? 0.1 : k % 4 == 0 ? 1.0 : 0.7; });
  EXPECT_NEAR(levels.white, 0.25, 0.01);
}

TEST(EchoLevels, FollowTheDisplay) {
  Speckle one, other;
  const EchoLevels levels = levels_of([&](int k) { return one(k < 300 ? 0.2 : 0.6); });
  const EchoLevels darker = levels_of([&](int k) { return 0.5 * other(k < 300 ? 0.2 : 0.6); });
  EXPECT_TRUE(levels.separate);
  EXPECT_TRUE(darker.separate);
  EXPECT_NEAR(darker.fluid, 0.5 * levels.fluid, 0.005);
  EXPECT_NEAR(darker.tissue, 0.5 * levels.tissue, 0.005);
}

TEST(EchoLevels, OneKindIsNotTwo) {
  for (const double level : {0.1, 0.3, 0.5, 0.8}) {
    Speckle speckle;
    EXPECT_FALSE(levels_of([&](int) { return speckle(level); }).separate) << level;
  }
  EXPECT_FALSE(levels_of([](int) { return 0.0; }).separate);
  EXPECT_FALSE(levels_of([](int) { return 1.0; }).separate);
}

TEST(EchoLevels, NothingInTheBoxIsNoKind) {
  const hw::AcquisitionOptions scan = plan().acquisition();
  const std::vector<float> frame(static_cast<std::size_t>(scan.sticks_per_frame) *
                                 static_cast<std::size_t>(scan.samples_per_stick));
  EXPECT_FALSE(
      measure_levels(plan(), {8, frame}, std::vector<SampleSpan>(std::size_t{8} * 16)).separate);
}

}  // namespace
}  // namespace wobblebench::render
