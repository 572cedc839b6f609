#include "render/reconstruction/frame_store.h"

#include "render/geometry/sample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <string>

namespace wobblebench::render {
namespace {

hw::AcquisitionPlan plan_of(int frames) {
  hw::AcquisitionOptions acquisition;
  acquisition.frames_per_volume = frames;
  acquisition.sticks_per_frame = 2;
  acquisition.samples_per_stick = 3;
  return {hw::ProbeOptions{}, acquisition};
}

std::vector<float> frame_of(float value) {
  return std::vector<float>(6, value);
}

const std::vector<double> kThree = {0.25, 0.5, 0.25};

TEST(FrameStore, FiltersExistingNeighbours) {
  FrameStore store(plan_of(4), kThree, 1);
  for (int f = 0; f < 4; ++f) store.put(f, frame_of(0.1f * float(f + 1)));
  EXPECT_FLOAT_EQ(store.filtered(1)[0], 0.25f * 0.1f + 0.5f * 0.2f + 0.25f * 0.3f);
  EXPECT_FLOAT_EQ(store.filtered(0)[5], (0.5f * 0.1f + 0.25f * 0.2f) / 0.75f);
  EXPECT_FLOAT_EQ(store.filtered(3)[5], (0.25f * 0.3f + 0.5f * 0.4f) / 0.75f);
}

TEST(FrameStore, CompletesALayerWhenAllItsFramesHaveArrived) {
  FrameStore store(plan_of(5), kThree, 1);
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
  FrameStore store(plan_of(5), kThree, 1);
  store.put(3, frame_of(1));
  EXPECT_EQ(store.take_changed(), (std::vector<int>{2, 3, 4}));
  EXPECT_TRUE(store.take_changed().empty());
}

TEST(FrameStore, ALayerOfTwoSlicesWaitsForBoth) {
  FrameStore store(plan_of(5), kThree, 2);
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
    FrameStore store(plan_of(9), trial % 4 < 2 ? kThree : std::vector<double>{1}, slices);
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
  FrameStore store(plan_of(4), {1}, 1);
  EXPECT_THROW(store.put(4, frame_of(0)), std::out_of_range);
  EXPECT_THROW(store.put(-1, frame_of(0)), std::out_of_range);
  std::vector<float> short_frame = frame_of(0);
  short_frame.pop_back();
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

}  // namespace
}  // namespace wobblebench::render
