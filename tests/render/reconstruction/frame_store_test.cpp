#include "render/reconstruction/frame_store.h"

#include "render/geometry/ray_sampling.h"
#include "render/geometry/slice_geometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <string>

namespace wobblebench::render {
namespace {

hw::AcquisitionPlan plan_of(int frames, int lines = 2, int samples = 3) {
  hw::AcquisitionOptions acquisition;
  acquisition.frames_per_volume = frames;
  acquisition.sticks_per_frame = lines;
  acquisition.samples_per_stick = samples;
  return {hw::ProbeOptions{}, acquisition};
}

hw::PolarFrame frame_of(float value) {
  hw::PolarFrame frame;
  frame.samples.assign(6, value);
  return frame;
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

/// Mode plain has one slice in a layer, mode fast two.
RenderOptions options_of(int taps_across_frames, PipelineMode mode = PipelineMode::plain) {
  RenderOptions options;
  options.ray_casting.kernel_space = KernelSpace::slice;
  options.ray_casting.kernel_3d = taps_across_frames;
  options.pipeline.mode = mode;
  return options;
}

const RenderOptions kThree = options_of(3);

/// The samples of frame 0 of a plan with this frame.
std::vector<float> received(const hw::PolarFrame& frame) {
  FrameStore store(plan_of(2, int(frame.arrived.size()), 2), {});
  store.put(0, frame);
  return store.received()[0];
}

TEST(FrameStore, FiltersExistingNeighbours) {
  FrameStore store(plan_of(4), kThree);
  for (int f = 0; f < 4; ++f) store.put(f, frame_of(0.1f * float(f + 1)));
  const auto weights = frame_weights(kThree.ray_casting);
  ASSERT_EQ(weights.size(), 3u);
  const double side = weights[0], middle = weights[1];
  EXPECT_NEAR(store.filtered(1)[0], side * 0.1 + middle * 0.2 + side * 0.3, 1e-7);
  EXPECT_NEAR(store.filtered(0)[5], (middle * 0.1 + side * 0.2) / (middle + side), 1e-7);
  EXPECT_NEAR(store.filtered(3)[5], (side * 0.3 + middle * 0.4) / (middle + side), 1e-7);
}

TEST(FrameStore, CompletesALayerWhenAllItsFramesHaveArrived) {
  FrameStore store(plan_of(5), kThree);
  store.put(0, frame_of(1));
  EXPECT_TRUE(store.take_complete().empty());
  store.put(1, frame_of(1));
  EXPECT_EQ(store.take_complete(), std::vector<int>{0});
  store.put(2, frame_of(1));
  EXPECT_EQ(store.take_complete(), std::vector<int>{1});
  store.put(3, frame_of(1));
  store.put(4, frame_of(1));
  EXPECT_TRUE(store.volume_complete());
  EXPECT_EQ(store.take_complete(), (std::vector<int>{2, 3, 4}));
  store.begin_volume();
  EXPECT_FALSE(store.volume_complete());
  EXPECT_TRUE(store.take_changed().empty());
}

TEST(FrameStore, AFrameChangesItsNeighboursOnce) {
  FrameStore store(plan_of(5), kThree);
  store.put(3, frame_of(1));
  EXPECT_EQ(store.take_changed(), (std::vector<int>{2, 3, 4}));
  EXPECT_TRUE(store.take_changed().empty());
}

TEST(FrameStore, ALayerOfTwoSlicesWaitsForBoth) {
  FrameStore store(plan_of(5), options_of(3, PipelineMode::fast));
  for (int f = 0; f < 2; ++f) store.put(f, frame_of(1));
  EXPECT_TRUE(store.take_complete().empty());  // slice 1 is made from frame 2 too
  store.put(2, frame_of(1));
  EXPECT_EQ(store.take_complete(), std::vector<int>{0});
  store.put(3, frame_of(1));
  store.put(4, frame_of(1));
  EXPECT_EQ(store.take_complete(), (std::vector<int>{1, 2, 3}));
  store.begin_volume();
  store.put(2, frame_of(1));
  EXPECT_EQ(store.take_changed(), (std::vector<int>{0, 1, 2, 3}));
}

TEST(FrameStore, EachLayerIsCompletedExactlyOnceInAnyOrder) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 100; ++trial) {
    const int slices = 1 + trial % 2;
    const auto mode = slices == 1 ? PipelineMode::plain : PipelineMode::fast;
    FrameStore store(plan_of(9), options_of(trial % 4 < 2 ? 3 : 1, mode));
    std::vector<int> order = {0, 1, 2, 3, 4, 5, 6, 7, 8}, taken(10 - slices, 0);
    std::shuffle(order.begin(), order.end(), random);
    for (int frame : order) {
      store.put(frame, frame_of(0.5f));
      for (int layer : store.take_complete()) ++taken[static_cast<std::size_t>(layer)];
    }
    EXPECT_EQ(taken, std::vector<int>(taken.size(), 1));
  }
}

TEST(FrameStore, RefusesAFrameOutsideThePlanOrOfAnotherSize) {
  FrameStore store(plan_of(4), {});
  EXPECT_THROW(store.put(4, frame_of(0)), std::out_of_range);
  EXPECT_THROW(store.put(-1, frame_of(0)), std::out_of_range);
  hw::PolarFrame short_frame = frame_of(0);
  short_frame.samples.pop_back();
  EXPECT_THROW(store.put(0, short_frame), std::invalid_argument);
}

TEST(FrameStore, CleansSamples) {
  EXPECT_EQ(clean_sample(0.25f), 0.25f);
  EXPECT_EQ(clean_sample(1e30f), 1);
  EXPECT_EQ(clean_sample(-2), 0);
  EXPECT_EQ(clean_sample(std::numeric_limits<float>::infinity()), 0);
  EXPECT_EQ(clean_sample(-std::numeric_limits<float>::infinity()), 0);
  EXPECT_EQ(clean_sample(std::numeric_limits<float>::quiet_NaN()), 0);
}

TEST(FrameStore, CleansTheSamplesOfAFrame) {
  hw::PolarFrame frame = ramp({1, 1});
  frame.samples = {std::numeric_limits<float>::quiet_NaN(), 2, -1, 0.5f};
  EXPECT_EQ(received(frame), (std::vector<float>{0, 1, 0, 0.5f}));
}

TEST(FrameStore, ALostStickIsTheMeanOfTheNearestThatArrivedByDistance) {
  const auto samples = received(ramp({1, 0, 1, 0, 0, 1, 1}));
  for (std::size_t l = 0; l < 7; ++l) EXPECT_NEAR(samples[2 * l], 0.1 * double(l), 1e-6) << l;
}

TEST(FrameStore, BeyondTheLastSticksThatArrivedItIsTheNearest) {
  const auto samples = received(ramp({0, 0, 1, 1, 0}));
  EXPECT_FLOAT_EQ(samples[0], 0.2f);
  EXPECT_FLOAT_EQ(samples[2], 0.2f);
  EXPECT_FLOAT_EQ(samples[8], 0.3f);
}

TEST(FrameStore, AFrameWithoutSticksIsEmpty) {
  for (const float sample : received(ramp({0, 0, 0}))) EXPECT_EQ(sample, 0);
}

/// The denser scan is converted once all frames of the scan are there.
TEST(FrameStore, AlignedFramesAreConvertedInPlaceOfTheScans) {
  RenderOptions options = options_of(1);
  options.reconstruction.sticks = Sticks::aligned;
  const hw::AcquisitionPlan plan = plan_of(3);
  const auto dense = dense_plan(plan, dense_factors(plan, options)).acquisition();
  const auto frames = static_cast<std::size_t>(dense.frames_per_volume);
  ASSERT_GT(frames, 3u);
  FrameStore store(plan, options);
  for (int f = 0; f < 3; ++f) store.put(f, frame_of(1));
  EXPECT_TRUE(store.take_changed().empty());
  store.put_aligned(std::vector<std::vector<float>>(frames, std::vector<float>(6, 0.5f)));
  EXPECT_EQ(store.filtered(int(frames) - 1)[0], 0.5f);
  EXPECT_EQ(store.received()[0][0], 1);
  EXPECT_EQ(store.take_complete().size(), frames);
  EXPECT_TRUE(store.take_complete().empty());
  EXPECT_THROW(store.put_aligned({}), std::logic_error);
}

}  // namespace
}  // namespace wobblebench::render
