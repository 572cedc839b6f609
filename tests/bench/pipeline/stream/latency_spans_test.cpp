// The parts of an age whose times are known.
#include "bench/pipeline/stream/stream_summary.h"

#include <gtest/gtest.h>

#include "tests/support/expect.h"

namespace wobblebench::bench {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

/// The times of its newest stick, in ms after it was fired: received 2, acquired 3, its frame
/// complete 4, taken 9, pass 1 done 16 (of which 5 are its own), pass 2 20 ms and pass 3 10 ms
/// long, ready 50.
StreamResult one_picture(bool scheduled) {
  const hw::HostTime fired{std::chrono::seconds(1000)};
  PictureTimes times;
  if (scheduled) times.first.fired = fired - milliseconds(100), times.last.fired = fired;
  times.first.received = fired - milliseconds(97);
  times.first.acquired = fired - milliseconds(96);
  times.last.received = fired + milliseconds(2);
  times.last.acquired = fired + milliseconds(3);
  times.complete = fired + milliseconds(4);
  times.taken = fired + milliseconds(9);
  times.pass_1_ms = 5;
  times.uploaded = fired + milliseconds(16);
  times.passes = {{"scan_conversion", 99}, {"ray_casting", 20}, {"surface_shading", 10}};
  times.ready = fired + milliseconds(50);
  StreamResult result;
  result.records.push_back(times);
  return result;
}

struct Expected {
  std::string from, to;
  bool on_device_clock;
  double ms;
};

void expect_spans(const std::vector<LatencySpan>& spans, const std::vector<Expected>& expected) {
  ASSERT_EQ(spans.size(), expected.size());
  for (std::size_t i = 0; i < spans.size(); ++i) {
    EXPECT_EQ(spans[i].from, expected[i].from);
    EXPECT_EQ(spans[i].to, expected[i].to);
    EXPECT_EQ(spans[i].on_device_clock, expected[i].on_device_clock) << spans[i].to;
    EXPECT_NEAR(spans[i].ms.value().p50, expected[i].ms, 1e-9) << spans[i].to;
    EXPECT_EQ(spans[i].ms->n, 1u);
  }
}

const std::vector<Expected> kBehindAcquisition = {{"acquired", "frame complete", false, 1},
                                                  {"frame complete", "taken", false, 5},
                                                  {"taken", "uploaded", false, 2},
                                                  {"uploaded", "scan_conversion", false, 5},
                                                  {"scan_conversion", "ray_casting", false, 20},
                                                  {"ray_casting", "surface_shading", false, 10},
                                                  {"surface_shading", "ready", false, 4}};

std::vector<Expected> with_acquisition(std::vector<Expected> expected) {
  expected.insert(expected.end(), kBehindAcquisition.begin(), kBehindAcquisition.end());
  return expected;
}

TEST(LatencySpans, AddUpToTheAgeWithTheModelledCardsOnItsOwnClock) {
  const CardDelays card{.first = {0.25, 1}, .last = {0.5, 1.25}};
  const LatencySpans spans = latency_spans(one_picture(true), card);
  expect_spans(spans.newest,
               with_acquisition({{"emission", "DMA complete", true, 0.5},
                                 {"DMA complete", "interrupt", true, 0.75},
                                 {"interrupt", "notified", false, 0.75},
                                 {"notified", "acquired", false, 1}}));
  expect_spans(spans.oldest,
               {{"emission", "DMA complete", true, 0.25},
                {"DMA complete", "interrupt", true, 0.75},
                {"interrupt", "notified", false, 2},
                {"notified", "acquired", false, 1}});
  EXPECT_EQ(spans.why_unknown, "");
  double sum_ms = 0;
  for (const LatencySpan& span : spans.newest) sum_ms += span.ms->p50;
  EXPECT_NEAR(sum_ms, 50, 1e-9);
}

TEST(LatencySpans, ARecordingHasNoCard) {
  const LatencySpans spans = latency_spans(one_picture(true), {});
  expect_spans(
      spans.newest,
      with_acquisition({{"emission", "notified", false, 2}, {"notified", "acquired", false, 1}}));
  EXPECT_TRUE(holds(spans.why_unknown, "DMA"));
}

TEST(LatencySpans, ADeviceWithAClockOfItsOwnTellsNothingOfWhatLiesBeforeItsNotification) {
  LatencySpans spans = latency_spans(one_picture(false), {});
  EXPECT_FALSE(spans.newest.front().ms);
  EXPECT_FALSE(spans.oldest.front().ms);
  EXPECT_NE(spans.why_unknown, "");
  spans.newest.erase(spans.newest.begin());
  expect_spans(spans.newest, with_acquisition({{"notified", "acquired", false, 1}}));
}

/// The scheduled emission of a lost stick lies behind the times of the one that came before it.
TEST(LatencySpans, LeaveOutPicturesWhoseStickWasLost) {
  StreamResult result = one_picture(true);
  result.records.push_back(result.records.front());
  result.records.back().last.arrived = false;
  result.records.back().last.received -= milliseconds(30);
  const LatencySpans spans = latency_spans(result, {});
  EXPECT_EQ(spans.newest.front().ms->n, 1u);
  EXPECT_EQ(spans.oldest.front().ms->n, 2u);
}

}  // namespace
}  // namespace wobblebench::bench
