// Streams in virtual time whose ages, rates and losses have closed forms.
#include "bench/studies/latency/virtual_stream.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bench/studies/latency/latency_study.h"
#include "bench/studies/latency/service_times.h"
#include "hw/wire/packet.h"

namespace wobblebench::bench {
namespace {

/// 37 frames of 64 lines of 207.8 us: 492 ms.
VirtualSetting setting_of(double frame_s, double picture_s, StreamPolicy policy) {
  return {.plan = hw::AcquisitionPlan({}, {}),
          .card = {},
          .times = {.wake = {{1e-3}},
                    .frame = {{frame_s}},
                    .last_frame = {{frame_s}},
                    .picture = {{picture_s}},
                    .written = {}},
          .queue = {.policy = policy},
          .volumes = 200};
}

double volume_s(const VirtualSetting& setting) {
  return 1e-3 * to_milliseconds(setting.plan.volume_duration());
}

TEST(VirtualStream, AFastRendererAddsItsOwnTimeToTheCards) {
  for (const auto policy : {StreamPolicy::newest, StreamPolicy::every}) {
    const auto setting = setting_of(2e-3, 50e-3, policy);
    const VirtualResult result = run_virtual_stream(setting);
    ASSERT_EQ(result.pictures.size(), 200u);
    EXPECT_EQ(result.superseded_volumes + result.sticks_lost, 0u);
    // A stick's echoes take its period; its packet, and those in its card's buffer, follow at 900
    // MB/s.
    const double period_s = setting.plan.stick_period_s();
    for (const VirtualPicture& picture : result.pictures) {
      EXPECT_NEAR(picture.age_newest_s(), period_s + 1e-3 + 2e-3 + 50e-3, 30e-6);
      EXPECT_NEAR(picture.last_fired_s - picture.first_fired_s, volume_s(setting) - period_s, 1e-6);
    }
  }
}

TEST(VirtualStream, NewestShowsAtTheRenderersRateAndStaysFresh) {
  // 37 x 4 ms + 700 ms = 848 ms for each picture of the newest of the volumes, 492 ms long.
  const auto setting = setting_of(4e-3, 700e-3, StreamPolicy::newest);
  const VirtualResult result = run_virtual_stream(setting);
  EXPECT_EQ(result.pictures.size() + result.superseded_volumes, 200u);
  const auto& last = result.pictures.back();
  const auto& first = result.pictures.front();
  const double each_s =
      (last.ready_s - first.ready_s) / static_cast<double>(result.pictures.size() - 1);
  EXPECT_GT(each_s, 0.848 - 1e-9);
  EXPECT_LT(each_s, 0.848 + volume_s(setting));
  for (const VirtualPicture& picture : result.pictures) {
    EXPECT_LT(picture.age_newest_s(), 2 * 0.848 + 1e-2) << picture.volume;
  }
}

TEST(VirtualStream, EveryLosesSticksOnceTheRingIsFull) {
  const auto setting = setting_of(4e-3, 700e-3, StreamPolicy::every);
  const VirtualResult result = run_virtual_stream(setting);
  EXPECT_EQ(result.pictures.size(), 200u);
  EXPECT_EQ(result.superseded_volumes, 0u);
  EXPECT_GT(result.sticks_lost, 0u);
  EXPECT_EQ(run_virtual_stream(setting_of(4e-3, 300e-3, StreamPolicy::every)).sticks_lost, 0u);
}

TEST(VirtualStream, AStallCountsInFullAndIsOver) {
  auto setting = setting_of(2e-3, 50e-3, StreamPolicy::newest);
  const double usual_s = run_virtual_stream(setting).pictures.front().age_newest_s();
  // From just before the end of volume 50 on.
  setting.stall = Stall{51 * volume_s(setting) - 1e-4, 0.2};
  const VirtualResult result = run_virtual_stream(setting);
  double worst_s = 0;
  for (const VirtualPicture& picture : result.pictures) {
    worst_s = std::max(worst_s, picture.age_newest_s());
    if (picture.volume > 51) {
      EXPECT_NEAR(picture.age_newest_s(), usual_s, 1e-9);
    }
  }
  EXPECT_NEAR(worst_s, usual_s + 0.2, 2e-3);
  // From the first stick of volume 51 on: the last of volume 50 was sent, that of 51 is due later.
  setting.stall->at_s = 51 * volume_s(setting);
  for (const VirtualPicture& picture : run_virtual_stream(setting).pictures) {
    EXPECT_NEAR(picture.age_newest_s(), usual_s, 1e-9) << picture.volume;
  }
}

TEST(VirtualStream, ASlowSinkReplacesPicturesOrHoldsTheRendererUp) {
  auto setting = setting_of(1e-3, 10e-3, StreamPolicy::newest);
  setting.times.written = {{1.3}};
  const VirtualResult newest = run_virtual_stream(setting);
  EXPECT_EQ(newest.superseded_volumes, 0u);
  EXPECT_EQ(newest.pictures.size() + newest.superseded_pictures, 200u);
  // One picture each 1.3 s of 200 x 0.492 s.
  EXPECT_NEAR(static_cast<double>(newest.pictures.size()), 200 * volume_s(setting) / 1.3, 3);
  setting.queue.policy = StreamPolicy::every;
  EXPECT_EQ(run_virtual_stream(setting).pictures.size(), 200u);
}

TEST(VirtualStream, ACardAnnouncesEachFrameAfterItsLastEcho) {
  const hw::AcquisitionPlan plan({}, {});
  for (const int buffers : {1, 4, 16}) {
    const auto times = frame_announcements_s(plan, {.buffers_per_interrupt = buffers});
    ASSERT_EQ(times.size(), 37u);
    const double frame_s = 64 * plan.stick_period_s();
    // A stick is announced at the latest with those that fill the buffers of an interrupt.
    const double longest_s = (buffers * 8192.0 / 2048 + 2) * plan.stick_period_s();
    for (std::size_t i = 0; i < times.size(); ++i) {
      const double echoed_s = static_cast<double>(i + 1) * frame_s;
      EXPECT_GE(times[i], echoed_s - 1e-9);
      EXPECT_LE(times[i], echoed_s + longest_s);
    }
    // The volume's end flushes: what is left takes less than a buffer's time on the bus.
    EXPECT_LE(times.back(), 37 * frame_s + buffers * 8192 / 900e6 + 1e-6);
  }
}

/// 2112 bytes a stick at 1 MB/s: 2.112 ms of transfer for each 5 ms stick; the configuration and
/// the volume's end go before and behind.
TEST(CardTimes, DmaAndInterruptOfEachStickFollowFromRateBufferAndLatency) {
  hw::AcquisitionOptions acquisition;
  acquisition.frames_per_volume = 2;
  acquisition.sticks_per_frame = 3;
  acquisition.samples_per_stick = 512;
  acquisition.dead_time_s = 5e-3;
  const hw::AcquisitionPlan plan({}, acquisition);
  const double period_s = plan.stick_period_s();
  std::vector<std::byte> packet, end;
  hw::Stick stick;
  stick.samples.resize(512);
  hw::encode(stick, packet);
  hw::encode(hw::VolumeEndPacket{}, end);
  const double stick_s = static_cast<double>(packet.size()) / 1e6;
  const double end_s = static_cast<double>(end.size()) / 1e6;
  // No buffer is full before the end, whose interrupt announces all sticks.
  const sim::CardOptions card{
      .buffer_bytes = 1 << 20, .payload_rate_mb_s = 1, .interrupt_latency_s = 30e-6};
  const auto times = card_times(plan, card);
  ASSERT_EQ(times.size(), 6u);
  const double interrupt_s = 6 * period_s + stick_s + end_s + 30e-6;
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(times[i].dma_complete_s, static_cast<double>(i + 1) * period_s + stick_s, 1e-8);
    EXPECT_NEAR(times[i].interrupt_s, interrupt_s, 1e-8);
  }
  const CardDelays delays = card_delays(plan, card);
  EXPECT_NEAR(delays.first.interrupt_ms, 1e3 * interrupt_s, 1e-5);
  EXPECT_NEAR(delays.last.dma_complete_ms, 1e3 * (period_s + stick_s), 1e-5);
  EXPECT_NEAR(delays.last.interrupt_ms, 1e3 * (period_s + stick_s + end_s + 30e-6), 1e-5);
}

TEST(Latency, ThePapersRendererIsSlowerThanSoundOnlyBelowFourFrames) {
  // 53.7 ms of 27 frames, 54.6 ms of 37: 51.27 ms + 0.09 ms a frame; sound 64 x 207.8 us a frame.
  const auto curves = crossover_curves(paper_times(), hw::AcquisitionPlan({}, {}));
  const auto& of_64 = curves.at(1);
  ASSERT_EQ(of_64.lines, 64);
  const auto at = std::ranges::find(of_64.depth_mm, 160.0) - of_64.depth_mm.begin();
  EXPECT_NEAR(of_64.frames.at(static_cast<std::size_t>(at)), 51.27 / (64 * 0.20779 - 0.09), 1e-3);
}

TEST(Latency, LossBeginsWhereTheRendererTakesAsLongAsSound) {
  // 37 x 2 ms + 226 ms = 300 ms for 2368 sticks: 7893 a second, whichever the policy.
  for (const LineRate& rate : first_losses(setting_of(2e-3, 226e-3, StreamPolicy::newest))) {
    EXPECT_NEAR(rate.per_s.median, 2368 / 0.3, 0.03 * 2368 / 0.3) << rate.loss;
  }
}

TEST(Latency, Pass1DependsOnTheNumberOfFramesLinearly) {
  const ServiceTimes one{.frame = {{2e-3}}, .last_frame = {{3e-3}}, .picture = {{0.1}}};
  const ServiceTimes half{.frame = {{3e-3}}, .last_frame = {{3e-3}}, .picture = {{0.1}}};
  // 36 x 2 = 72 ms of 37 frames, 18 x 3 = 54 ms of 19: 1 ms a frame, so 63 ms of 28.
  const KnownTimes known{"made up", one, 37, half, 19};
  EXPECT_NEAR(27 * known.at(28).frame.mean(), 63e-3, 1e-9);
  EXPECT_NEAR(known.at(37).frame.mean(), 2e-3, 1e-12);
}

}  // namespace
}  // namespace wobblebench::bench
