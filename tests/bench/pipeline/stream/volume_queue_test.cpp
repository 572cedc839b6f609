// What the queue drops, what it keeps, and when its writer waits.
#include "bench/pipeline/stream/stream_queues.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "tests/hw/support/streams.h"

namespace wobblebench::bench {
namespace {

constexpr int kFrames = 3;
constexpr int kSticks = 4;  // of each frame

StreamFrame frame_of(std::uint32_t volume, int frame) {
  StreamFrame made;
  made.volume = volume;
  made.frame = frame;
  made.sticks = kSticks;
  made.ends_volume = frame + 1 == kFrames;
  return made;
}

void push_volume(VolumeQueue& queue, std::uint32_t volume) {
  for (int frame = 0; frame < kFrames; ++frame) queue.push(frame_of(volume, frame));
}

std::vector<std::uint32_t> pop_volumes(VolumeQueue& queue) {
  queue.close();
  std::vector<std::uint32_t> volumes;
  while (const auto frame = queue.pop()) {
    if (frame->ends_volume) volumes.push_back(frame->volume);
  }
  return volumes;
}

TEST(VolumeQueue, NewestKeepsTheNewestWholeVolumeAndTheOneUnderWay) {
  VolumeQueue queue({.policy = StreamPolicy::newest});
  for (std::uint32_t volume = 0; volume < 5; ++volume) push_volume(queue, volume);
  queue.push(frame_of(5, 0));
  EXPECT_EQ(queue.volumes(), 2);
  EXPECT_EQ(queue.statistics().superseded.volumes, 4u);
  EXPECT_EQ(queue.statistics().superseded.sticks, 4u * kFrames * kSticks);
  EXPECT_EQ(pop_volumes(queue), (std::vector<std::uint32_t>{4}));
}

TEST(VolumeQueue, NewestFinishesTheVolumeThatWasBegun) {
  VolumeQueue queue({.policy = StreamPolicy::newest});
  push_volume(queue, 0);
  ASSERT_EQ(queue.pop()->frame, 0);
  for (std::uint32_t volume = 1; volume < 4; ++volume) push_volume(queue, volume);
  EXPECT_EQ(queue.statistics().superseded.volumes, 2u);
  EXPECT_EQ(pop_volumes(queue), (std::vector<std::uint32_t>{0, 3}));
  EXPECT_EQ(queue.statistics().most_volumes, 3);
}

TEST(VolumeQueue, EveryWaitsForRoomAndDropsNothing) {
  VolumeQueue queue({.policy = StreamPolicy::every, .volumes = 2});
  std::jthread writer([&] {
    for (std::uint32_t volume = 0; volume < 6; ++volume) push_volume(queue, volume);
    queue.close();
  });
  std::vector<std::uint32_t> volumes;
  while (const auto frame = queue.pop()) {
    EXPECT_LE(queue.volumes(), 2);
    if (frame->ends_volume) volumes.push_back(frame->volume);
  }
  EXPECT_EQ(volumes, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(queue.statistics().superseded.volumes, 0u);
  EXPECT_LE(queue.statistics().most_volumes, 2);
}

TEST(VolumeQueue, StopWakesTheWriterAndCountsWhatIsLeft) {
  VolumeQueue queue({.policy = StreamPolicy::every, .volumes = 1});
  push_volume(queue, 0);
  bool pushed = true;
  std::jthread writer([&] { pushed = queue.push(frame_of(1, 0)); });
  queue.stop();
  writer.join();
  EXPECT_FALSE(pushed);
  EXPECT_FALSE(queue.pop());
  EXPECT_EQ(queue.statistics().left_sticks, std::uint64_t{(kFrames + 1) * kSticks});
}

/// Frames come in order and whole, whatever the two threads do; sticks are popped, superseded or
/// left.
TEST(VolumeQueue, RandomSchedulesLoseNoStickAndMixNoVolumes) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const auto policy = seed % 2 == 0 ? StreamPolicy::newest : StreamPolicy::every;
    VolumeQueue queue({.policy = policy, .volumes = 64});
    std::uint64_t step = 0, popped = 0;
    std::uint32_t volume = 0;
    int frame = 0, expected_frame = 0;
    std::int64_t last_volume = -1;
    while (volume < 30) {
      if (hw::hash(seed, step++) % 3 != 0) {
        queue.push(frame_of(volume, frame));
        if (++frame == kFrames) ++volume, frame = 0;
      } else if (!queue.empty()) {
        const auto taken = queue.pop();
        popped += kSticks;
        ASSERT_EQ(taken->frame, expected_frame) << seed;
        if (expected_frame == 0) {
          ASSERT_GT(taken->volume, last_volume) << seed;
        } else {
          ASSERT_EQ(taken->volume, last_volume) << seed;
        }
        last_volume = taken->volume;
        expected_frame = (expected_frame + 1) % kFrames;
      }
    }
    // A volume of which frames were popped is left whole.
    const std::uint64_t of_begun = static_cast<std::uint64_t>(expected_frame) * kSticks;
    queue.stop();
    const QueueStatistics statistics = queue.statistics();
    EXPECT_EQ(popped - of_begun + statistics.superseded.sticks + statistics.left_sticks,
              30u * kFrames * kSticks)
        << seed;
  }
}

TEST(VolumeQueue, RefusesARoomForNoVolume) {
  EXPECT_THROW(VolumeQueue({.policy = StreamPolicy::every, .volumes = 0}), InvalidOption);
}

}  // namespace
}  // namespace wobblebench::bench
