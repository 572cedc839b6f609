// The bytes of the simulated board: sticks as planned, the same for a seed on any run.
#include "sim/card/sim_link.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <future>
#include <thread>

#include "hw/board/volume_assembly.h"
#include "hw/wire/decoder.h"
#include "hw/wire/packet.h"
#include "tests/hw/support/collect.h"

namespace wobblebench::sim {
namespace {

hw::AcquisitionPlan small_plan(int volumes = 1, hw::MotorMode motor = hw::MotorMode::stepped) {
  hw::AcquisitionOptions acquisition;
  acquisition.sticks_per_frame = 16;
  acquisition.frames_per_volume = 9;
  acquisition.samples_per_stick = 128;
  acquisition.volumes = volumes;
  acquisition.motor = motor;
  return {{}, acquisition};
}

std::vector<std::byte> all_bytes(const hw::AcquisitionPlan& plan,
                                 const SimulationOptions& options,
                                 const SimLinkOptions& link_options = {}) {
  const auto phantom = phantoms::make_phantom({.name = "sphere", .voxel_m = 1e-3});
  SimLink link(
      stick_source({phantoms::still_at(phantom, phantom.suggested_position_m()), plan, options}),
      link_options);
  std::vector<std::byte> bytes, chunk(777);
  for (;;) {
    const auto result = link.read(chunk, hw::HostTime::max());
    if (result.status != hw::ReadStatus::ok) return bytes;
    bytes.insert(
        bytes.end(), chunk.begin(), chunk.begin() + static_cast<std::ptrdiff_t>(result.bytes));
  }
}

TEST(SimLink, BytesDoNotDependOnThreadsOrRuns) {
  for (const Rung rung : {Rung::geometry, Rung::field}) {
    SimulationOptions options;
    options.fidelity = rung;
    options.threads = 1;
    const auto one = all_bytes(small_plan(), options);
    EXPECT_EQ(one, all_bytes(small_plan(), options)) << "a second run differs";
    options.threads = 2;
    EXPECT_EQ(one, all_bytes(small_plan(), options)) << "two threads differ from one";
    options.threads = 4;
    EXPECT_EQ(one, all_bytes(small_plan(), options)) << "four threads differ from one";
  }
}

TEST(SimLink, SpeckleDependsOnTheSeed) {
  SimulationOptions a, b;
  b.seed = a.seed + 1;
  EXPECT_NE(all_bytes(small_plan(), a), all_bytes(small_plan(), b));
}

TEST(SimLink, ConfigurationsStateTheDisplayScale) {
  SimulationOptions options;
  options.fidelity = Rung::geometry;
  options.full_scale_db = -12;
  options.dynamic_range_db = 72;
  options.tgc_db_per_cm_mhz = 0.4;
  hw::Decoder decoder;
  decoder.feed(all_bytes(small_plan(), options));
  const auto packet = decoder.next();
  const hw::DisplayScale expected{
      .full_scale_db = -12, .dynamic_range_db = 72, .tgc_db_per_cm_mhz = 0.4};
  EXPECT_TRUE(std::get<hw::ConfigurationPacket>(packet.value()).display_scale == expected);
}

TEST(SimLink, EveryStickCarriesItsOwnTimeAndAngle) {
  const auto plan = small_plan(2, hw::MotorMode::continuous);
  hw::Decoder decoder;
  decoder.feed(all_bytes(plan, {}));
  std::uint64_t sticks = 0, configurations = 0, ends = 0;
  while (const auto packet = decoder.next()) {
    configurations += std::holds_alternative<hw::ConfigurationPacket>(*packet);
    ends += std::holds_alternative<hw::VolumeEndPacket>(*packet);
    const auto* found = std::get_if<hw::StickPacket>(&*packet);
    if (!found) continue;
    const hw::Stick& stick = found->stick;
    ASSERT_EQ(stick.sequence, sticks);
    EXPECT_EQ(stick.time, plan.stick_time(sticks));
    EXPECT_EQ(stick.motor_angle_rad, plan.motor_angle_rad(stick.index));
    for (float sample : stick.samples) ASSERT_TRUE(sample >= 0 && sample <= 1);
    ++sticks;
  }
  EXPECT_EQ(sticks, 2u * 16 * 9);
  EXPECT_EQ(configurations, 2u);
  EXPECT_EQ(ends, 2u);
  EXPECT_EQ(decoder.damage().bytes_skipped, 0u);
}

std::vector<hw::Stick> sticks_of(const std::vector<std::byte>& bytes) {
  hw::Decoder decoder;
  decoder.feed(bytes);
  std::vector<hw::Stick> sticks;
  while (const auto packet = decoder.next()) {
    if (const auto* found = std::get_if<hw::StickPacket>(&*packet)) sticks.push_back(found->stick);
  }
  return sticks;
}

TEST(SimLink, ALaterFirstVolumeIsThatOfTheWholeStream) {
  for (const int ahead : {0, 1}) {
    const auto whole = sticks_of(all_bytes(small_plan(5, hw::MotorMode::alternating), {}));
    const auto part = sticks_of(all_bytes(small_plan(2, hw::MotorMode::alternating),
                                          {},
                                          {.volumes_ahead = ahead, .first_volume = 3}));
    ASSERT_EQ(part.size(), 2u * 16 * 9);
    for (std::size_t i = 0; i < part.size(); ++i) {
      const hw::Stick& expected = whole.at(3u * 16 * 9 + i);
      ASSERT_EQ(part[i].sequence, expected.sequence);
      ASSERT_EQ(part[i].index.volume, expected.index.volume);
      ASSERT_EQ(part[i].time, expected.time);
      ASSERT_EQ(part[i].motor_angle_rad, expected.motor_angle_rad);
      ASSERT_EQ(part[i].samples, expected.samples) << i;
    }
  }
}

TEST(SimLink, VolumesAtRestShareSpeckleButNotNoise) {
  const auto plan = small_plan(2);
  const auto phantom = phantoms::make_phantom({.name = "sphere", .voxel_m = 1e-3});
  SimulationOptions options;
  options.noise_db = kZeroAmplitude_db;
  const auto subject = phantoms::still_at(phantom, phantom.suggested_position_m());
  const ProbeSimulator noiseless(subject, plan, options);
  EXPECT_EQ(noiseless.volume(0), noiseless.volume(1));
  options.noise_db = -60;
  const ProbeSimulator noisy(subject, plan, options);
  EXPECT_NE(noisy.volume(0), noisy.volume(1));
}

TEST(SimLink, ArrivesCompleteThroughTheBoard) {
  const auto plan = small_plan(3);
  const auto phantom = phantoms::make_phantom({.name = "sphere", .voxel_m = 1e-3});
  const ProbeSimulator simulator(
      phantoms::still_at(phantom, phantom.suggested_position_m()), plan, {});
  hw::Board board(std::make_unique<SimLink>(stick_source(simulator)), {.ring_slots = 8});
  board.start();
  hw::VolumeAssembly assembly(board);
  for (std::uint32_t v = 0; v < 3; ++v) {
    const auto volume = assembly.next(hw::HostTime::max());
    ASSERT_TRUE(volume);
    EXPECT_EQ(volume->missing_sticks(), 0);
    VolumeSamples samples;
    for (const auto& frame : volume->frames()) {
      samples.insert(samples.end(), frame.samples.begin(), frame.samples.end());
    }
    EXPECT_EQ(samples, simulator.volume(v));
  }
  EXPECT_FALSE(assembly.next(hw::HostTime::max()));
  EXPECT_TRUE(assembly.ended());
  EXPECT_EQ(board.account().emitted, 3u * 16 * 9);
  EXPECT_EQ(board.account().delivered, 3u * 16 * 9);
  EXPECT_TRUE(board.account().balanced());
}

TEST(SimLink, BlocksHoldTheSticksOfTheirVolume) {
  hw::AcquisitionOptions acquisition = small_plan(2, hw::MotorMode::alternating).acquisition();
  acquisition.frames_per_volume = 20;  // a block of 16 frames, and one of 4
  const hw::AcquisitionPlan plan({}, acquisition);
  const auto phantom = phantoms::make_phantom({.name = "sphere", .voxel_m = 1e-3});
  const ProbeSimulator simulator(
      phantoms::still_at(phantom, phantom.suggested_position_m()), plan, {});
  for (std::uint32_t v = 0; v < 2; ++v) {
    const std::uint64_t first = plan.first_sequence(v);
    VolumeSamples samples = simulator.block(first);
    EXPECT_EQ(samples.size(), 16u * 16 * 128);
    const auto rest = simulator.block(first + 16 * 16);
    samples.insert(samples.end(), rest.begin(), rest.end());
    EXPECT_EQ(samples, simulator.volume(v)) << "volume " << v;
  }
}

TEST(SimLink, CancelAndCloseEndReading) {
  const auto phantom = phantoms::make_phantom({.name = "sphere", .voxel_m = 1e-3});
  SimLink link(stick_source(
      {phantoms::still_at(phantom, phantom.suggested_position_m()), small_plan(), {}}));
  std::vector<std::byte> buffer(64);
  link.cancel();
  EXPECT_EQ(link.read(buffer, hw::HostTime::max()).status, hw::ReadStatus::cancelled);
  link.resume();
  EXPECT_EQ(link.read(buffer, hw::HostTime::max()).status, hw::ReadStatus::ok);
  link.close();
  EXPECT_EQ(link.read(buffer, hw::HostTime::max()).status, hw::ReadStatus::lost);
}

/// Host time that a test sets.
class ManualTime : public hw::HostTimeSource {
 public:
  hw::HostTime now() const override { return now_; }
  void advance(hw::HostClock::duration duration) { now_ += duration; }

 private:
  hw::HostTime now_{};
};

/// Sticks of zeros, without simulation.
StickSource blank_sticks(const hw::AcquisitionPlan& plan) {
  return {
      plan, hw::SampleScale::log_compressed, [plan](std::uint64_t) {
        return std::vector<float>(static_cast<std::size_t>(plan.acquisition().sticks_per_frame) *
                                  static_cast<std::size_t>(plan.acquisition().samples_per_stick));
      }};
}

TEST(SimLink, RealtimeSendsAStickAfterItsPeriod) {
  const auto plan = small_plan();
  ManualTime time;
  SimLinkOptions options{.pace = hw::Pace::realtime, .volumes_ahead = 0};
  options.card.buffer_bytes = 64;  // an interrupt for every few bytes
  options.card.buffers = 1 << 16;
  SimLink link(blank_sticks(plan), options, {}, &time);
  hw::Decoder decoder;
  std::vector<std::byte> buffer(1 << 16);
  std::uint64_t sticks = 0;
  for (int step = 0; step < 400; ++step) {
    const auto result = link.read(buffer, hw::HostTime::min());
    decoder.feed(std::span(buffer).first(result.bytes));
    while (const auto packet = decoder.next()) sticks += packet->index() == 1;
    // All sticks whose period is over, except one whose end lies in a buffer that is not full, and
    // one in transfer.
    const double elapsed_s = std::chrono::duration<double>(time.now().time_since_epoch()).count();
    const auto due = static_cast<std::uint64_t>(elapsed_s / plan.stick_period_s());
    EXPECT_LE(sticks, due);
    EXPECT_GE(sticks + 2, std::min<std::uint64_t>(due, 16 * 9));
    time.advance(std::chrono::microseconds(100));
  }
  EXPECT_EQ(sticks, 16u * 9);
}

TEST(SimLink, RealtimeCountsPacketsDroppedWhenTheHostDoesNotRead) {
  const auto plan = small_plan(4);
  ManualTime time;
  const auto statistics = std::make_shared<SimLinkStatistics>();
  SimLinkOptions options{.pace = hw::Pace::realtime, .volumes_ahead = 0};
  options.card.buffers = 4;
  hw::Board board(std::make_unique<SimLink>(blank_sticks(plan), options, statistics, &time),
                  {.reader = hw::ReaderMode::stepped});
  board.start();
  board.step();
  time.advance(std::chrono::seconds(1));
  while (board.step()) {
  }
  EXPECT_GT(statistics->packets_dropped, 500u) << "4 x 8 KiB of 4 x 144 sticks of 576 bytes";
  EXPECT_EQ(statistics->sticks_emitted, 4u * 16 * 9);
  EXPECT_TRUE(board.account().balanced());
  EXPECT_LE(board.account().emitted, 4u * 16 * 9);
  EXPECT_LT(board.account().delivered, 60u);
  EXPECT_GT(board.account().delivered, 40u);
}

TEST(SimLink, TheFirstReadStartsTheAcquisition) {
  const auto plan = small_plan();
  ManualTime time;
  time.advance(std::chrono::hours(1));
  SimLink link(blank_sticks(plan), {.pace = hw::Pace::realtime, .volumes_ahead = 0}, {}, &time);
  std::vector<std::byte> buffer(64);
  EXPECT_EQ(link.read(buffer, hw::HostTime::min()).status, hw::ReadStatus::timeout);
  time.advance(std::chrono::seconds(1));
  EXPECT_EQ(link.read(buffer, hw::HostTime::min()).status, hw::ReadStatus::ok);
}

/// A reader that pauses for five volumes misses five volumes, less what the card's ring holds: the
/// probe does not wait for it, however few volumes are computed ahead.
TEST(SimLink, APauseOfTheReaderDoesNotMoveTheProbesClock) {
  constexpr int kVolumes = 20;
  const auto plan = small_plan(kVolumes);
  for (const int ahead : {0, 1, 16}) {
    const auto statistics = std::make_shared<SimLinkStatistics>();
    SimLinkOptions options{.pace = hw::Pace::realtime, .volumes_ahead = ahead};
    options.card.buffers = 4;  // of 8 KiB: 56 of these sticks
    SimLink link(blank_sticks(plan), options, statistics);
    std::vector<std::byte> buffer(1 << 16);
    ASSERT_EQ(link.read(buffer, hw::HostTime::max()).status, hw::ReadStatus::ok);
    const auto epoch = link.epoch().value();
    for (const auto deadline = hw::patience();
         statistics->sticks_emitted < std::uint64_t{5} * 16 * 9;) {
      ASSERT_TRUE(hw::HostClock::now() < deadline) << ahead << ": the probe waits for its reader";
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_GT(statistics->packets_dropped, 4u * 16 * 9 - 60) << ahead;
    while (link.read(buffer, hw::HostTime::max()).status == hw::ReadStatus::ok) {
    }
    // On a busy machine a volume may be late.
    EXPECT_LT(to_milliseconds(link.epoch().value() - epoch), statistics->late_ms + 1e-3) << ahead;
    EXPECT_EQ(statistics->sticks_emitted, kVolumes * 16u * 9) << ahead;
  }
}

TEST(SimLink, CancelDoesNotWaitForAComputation) {
  std::promise<void> ending;
  std::atomic<bool> ended = false;
  StickSource slow = blank_sticks(small_plan());
  slow.block = [&, make = slow.block, end = ending.get_future().share()](std::uint64_t first) {
    end.wait_until(hw::patience());
    ended = true;
    return make(first);
  };
  SimLink link(std::move(slow));
  std::vector<std::byte> buffer(64);
  std::thread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // so that the read waits
    link.cancel();
  });
  EXPECT_EQ(link.read(buffer, hw::HostTime::max()).status, hw::ReadStatus::cancelled);
  EXPECT_FALSE(ended);
  canceller.join();
  ending.set_value();
  link.resume();
  EXPECT_EQ(link.read(buffer, hw::HostTime::max()).status, hw::ReadStatus::ok);
}

TEST(SimLink, AFailedSimulationIsALossWithItsReason) {
  StickSource failing = blank_sticks(small_plan());
  failing.block = [](std::uint64_t) -> std::vector<float> {
    throw std::runtime_error("no tissue");
  };
  for (const int ahead : {0, 1}) {
    SimLink link(failing, {.volumes_ahead = ahead});
    std::vector<std::byte> buffer(64);
    EXPECT_EQ(link.read(buffer, hw::HostTime::max()).status, hw::ReadStatus::lost);
    EXPECT_EQ(link.loss(), "the simulation failed: no tissue");
  }
}

TEST(SimLink, AVolumeEndsWithItsLastStickBeforeTheFlyBack) {
  const auto plan = small_plan(2, hw::MotorMode::fly_back);
  SimLink link(blank_sticks(plan));
  hw::Decoder decoder;
  std::vector<std::byte> buffer(1 << 20);
  std::vector<hw::DeviceTime> ends;
  for (;;) {
    const auto result = link.read(buffer, hw::HostTime::max());
    if (result.status != hw::ReadStatus::ok) break;
    decoder.feed(std::span(buffer).first(result.bytes));
    while (const auto packet = decoder.next()) {
      if (const auto* end = std::get_if<hw::VolumeEndPacket>(&*packet)) ends.push_back(end->time);
    }
  }
  ASSERT_EQ(ends.size(), 2u);
  EXPECT_EQ(ends[0], plan.volume_end_time(0));
  EXPECT_EQ(ends[1], plan.volume_end_time(1));
}

}  // namespace
}  // namespace wobblebench::sim
