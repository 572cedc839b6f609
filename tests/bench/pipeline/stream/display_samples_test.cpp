#include "bench/pipeline/stream/stream_source.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/user_error.h"
#include "bench/pipeline/acquire.h"
#include "tests/support/expect.h"

namespace wobblebench::bench {
namespace {

/// One volume of two frames of ten sticks of 50 samples; `sample(i)` is sample i of 1000.
template <class Sample>
hw::PolarVolume volume_of(hw::SampleScale scale, const Sample& sample) {
  const hw::AcquisitionPlan plan(
      {}, {.sticks_per_frame = 10, .samples_per_stick = 50, .frames_per_volume = 2});
  hw::PolarVolume volume(plan);
  int next = 0;
  for (std::uint64_t sequence = 0; sequence < 20; ++sequence) {
    hw::Stick stick;
    stick.index = plan.index(sequence);
    stick.scale = scale;
    for (int k = 0; k < 50; ++k) stick.samples.push_back(sample(next++));
    volume.place(stick);
  }
  return volume;
}

constexpr hw::DisplayScale kScale{
    .full_scale_db = -15, .dynamic_range_db = 40, .tgc_db_per_cm_mhz = 0.3};

hw::Configuration configuration(hw::StreamOrigin source, const hw::DisplayScale& scale = {}) {
  return {.plan = {{}, {}}, .source = source, .display_scale = scale};
}

std::string refusal(hw::PolarVolume volume,
                    hw::StreamOrigin source,
                    std::optional<double> dynamic_range_db = 60) {
  return refusal_of<UserError>(
      [&] { make_displayable(volume, configuration(source), dynamic_range_db, "x"); });
}

TEST(DisplaySamples, LogCompressedOnesStayAsTheyAre) {
  auto volume =
      volume_of(hw::SampleScale::log_compressed, [](int i) { return static_cast<float>(i) / 999; });
  const auto before = volume.frame(1).samples;
  const auto received =
      make_displayable(volume, configuration(hw::StreamOrigin::hardware), 60, "x");
  EXPECT_EQ(volume.frame(1).samples, before);
  EXPECT_EQ(received.count, 1000u);
  EXPECT_EQ(received.out_of_range, 0u);
  EXPECT_EQ(received.least, 0);
  EXPECT_EQ(received.most, 1);
  EXPECT_FALSE(received.dynamic_range_db);
}

TEST(DisplaySamples, SomeOutOfRangeAreCounted) {
  auto volume = volume_of(hw::SampleScale::log_compressed, [](int i) {
    if (i == 7) return -0.25f;
    if (i == 800) return 3.5f;
    return i == 900 ? std::nanf("") : 0.5f;
  });
  const auto received =
      make_displayable(volume, configuration(hw::StreamOrigin::hardware), 60, "x");
  EXPECT_EQ(received.out_of_range, 3u);
  EXPECT_EQ(received.least, -0.25f);
  EXPECT_EQ(received.most, 3.5f);
}

TEST(DisplaySamples, AnotherScaleIsRefused) {
  const auto bytes =
      volume_of(hw::SampleScale::log_compressed, [](int i) { return static_cast<float>(i % 256); });
  EXPECT_EQ(refusal(bytes, hw::StreamOrigin::hardware),
            "--board = x: its samples go from 0 to 255, 99.2 % of them out of range; they must be "
            "finite, and log-compressed from 0 to 1");
}

TEST(DisplaySamples, LinearOnesNeedAFullScaleAndADynamicRange) {
  const auto linear = volume_of(hw::SampleScale::linear_envelope, [](int) { return 0.5f; });
  EXPECT_EQ(refusal(linear, hw::StreamOrigin::simulated), "");
  const std::string unknown =
      "--board = x: its samples are linear envelopes of unknown full scale; they must be "
      "log-compressed, or its configuration must state the display scale";
  EXPECT_EQ(refusal(linear, hw::StreamOrigin::hardware), unknown);
  EXPECT_EQ(refusal(linear, hw::StreamOrigin::simulated, std::nullopt), unknown);
}

/// 0.1 is 20 dB below full scale: half of 40 dB, two thirds up of 60 dB.
TEST(DisplaySamples, LinearOnesOfHardwareThatStatesItsScaleAreLogCompressed) {
  const auto hardware = configuration(hw::StreamOrigin::hardware, kScale);
  const auto linear = [] {
    return volume_of(hw::SampleScale::linear_envelope, [](int) { return 0.1f; });
  };
  auto as_stated = linear();
  EXPECT_EQ(make_displayable(as_stated, hardware, std::nullopt, "x").dynamic_range_db, 40);
  EXPECT_NEAR(as_stated.frame(1).samples.front(), 0.5, 1e-6);
  auto as_asked_for = linear();
  EXPECT_EQ(make_displayable(as_asked_for, hardware, 60, "x").dynamic_range_db, 60);
  EXPECT_NEAR(as_asked_for.frame(1).samples.front(), 2.0 / 3, 1e-6);
}

/// Log-compressed on arrival, a linear envelope gives what the simulator's own log compression
/// does.
TEST(DisplaySamples, OfALinearSimulationAreThoseOfALogCompressedOne) {
  Scene scene = load_scene({},
                           {"phantom.name=sphere",
                            "phantom.voxel_mm=2",
                            "acquisition.frames_per_volume=5",
                            "acquisition.sticks_per_frame=16"});
  const auto phantom = phantoms::make_phantom(scene.phantom);
  const Acquisition log = acquire_simulated(resolve_scene(scene, phantom));
  scene.simulation.output = hw::SampleScale::linear_envelope;
  const Acquisition linear = acquire_simulated(resolve_scene(scene, phantom));
  EXPECT_EQ(linear.samples.dynamic_range_db, 60);
  EXPECT_EQ(linear.volume.scale(), hw::SampleScale::log_compressed);
  double largest = 0;
  for (int frame = 0; frame < 5; ++frame) {
    for (std::size_t i = 0; i < log.volume.frame(frame).samples.size(); ++i) {
      const auto difference =
          log.volume.frame(frame).samples[i] - linear.volume.frame(frame).samples[i];
      largest = std::max(largest, static_cast<double>(std::abs(difference)));
    }
  }
  EXPECT_LT(largest, 1e-5);
}

}  // namespace
}  // namespace wobblebench::bench
