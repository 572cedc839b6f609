// Ages and rates of a stream whose times are known.
#include "bench/pipeline/stream/stream_summary.h"

#include <gtest/gtest.h>

namespace wobblebench::bench {
namespace {

using std::chrono::milliseconds;

/// Ten volumes of 100 ms of sound; each is ready 50 ms after its last stick, the sixth 250 ms.
StreamResult ten_volumes(bool scheduled) {
  StreamResult result;
  const hw::HostTime epoch{std::chrono::seconds(1000)};
  for (int volume = 0; volume < 10; ++volume) {
    PictureTimes times;
    const hw::HostTime first = epoch + milliseconds(100 * volume);
    const hw::HostTime last = first + milliseconds(99);
    if (scheduled) times.first.fired = first, times.last.fired = last;
    times.first.acquired = first + milliseconds(1);
    times.last.acquired = last + milliseconds(1);
    times.uploaded = last + milliseconds(10);
    times.ready = last + milliseconds(volume == 5 ? 250 : 50);
    times.written = times.ready + milliseconds(2);
    result.records.push_back(times);
  }
  result.shown.volumes = result.reader.volumes = 10;
  result.renderer_busy_ms = 400;
  result.sink_busy_ms = 20;
  result.reader.busy_ms = 10;
  return result;
}

TEST(StreamSummary, AgesCountFromScheduledEmissionSoThatAStallCountsInFull) {
  const StreamSummary summary = summarize(ten_volumes(true), 100, 0);
  EXPECT_TRUE(summary.scheduled);
  EXPECT_NEAR(summary.age_newest.p50, 50, 1e-6);
  EXPECT_NEAR(summary.age_newest.max, 250, 1e-6);
  EXPECT_NEAR(summary.age_oldest.p50, 149, 1e-6);
  EXPECT_EQ(summary.age_newest.n, 10u);
}

TEST(StreamSummary, WithoutAScheduleAgesCountFromAcquisition) {
  const StreamSummary summary = summarize(ten_volumes(false), 0, 0);
  EXPECT_FALSE(summary.scheduled);
  EXPECT_NEAR(summary.age_newest.p50, 49, 1e-6);
}

TEST(StreamSummary, TheHeaviestStageIsTheBottleneck) {
  const StreamSummary sound = summarize(ten_volumes(true), 100, 0);
  EXPECT_EQ(bottleneck_of(sound).stage, "sound");
  EXPECT_NEAR(bottleneck_of(sound).times_the_next, 2.5, 1e-9);
  EXPECT_EQ(bottleneck_of(summarize(ten_volumes(true), 0, 0)).stage, "renderer");
  EXPECT_EQ(bottleneck_of(summarize(ten_volumes(true), 100, 500)).stage, "simulator");
}

TEST(StreamSummary, RatesAreOfTheIntervalsBetweenPictures) {
  const StreamSummary summary = summarize(ten_volumes(true), 100, 0);
  EXPECT_NEAR(summary.seconds, 0.9, 1e-9);
  EXPECT_NEAR(summary.pictures_per_s, 10, 1e-9);
  EXPECT_NEAR(summary.volumes_per_s, 10, 1e-9);
  // Intervals: seven of 100 ms, one of 300 and one of -100 about the late picture.
  EXPECT_NEAR(summary.jitter_ms, 100, 1e-6);
}

}  // namespace
}  // namespace wobblebench::bench
