// Every frame of every volume comes once, in the order of acquisition, with the sticks that came.
#include "bench/pipeline/stream/frame_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/user_error.h"
#include "hw/wire/decoder.h"
#include "tests/hw/support/memory_link.h"
#include "tests/hw/support/streams.h"

namespace wobblebench::bench {
namespace {

struct Read {
  std::vector<StreamFrame> frames;
  ReaderStatistics statistics;
  hw::BoardAccount account;
};

Read read(const hw::AcquisitionPlan& plan,
          const std::vector<hw::Bytes>& packets,
          std::uint64_t volumes = 0) {
  hw::Board board(std::make_unique<hw::MemoryLink>(hw::join(packets)));
  board.start();
  VolumeQueue queue({.policy = StreamPolicy::every, .volumes = 64});
  const StreamSource source{.board = board,
                            .plan = plan,
                            .name = "test",
                            .configuration = {},
                            .dynamic_range_db = [](const hw::DisplayScale&) { return 60.0; }};
  FrameReader reader(source, queue, volumes, /*keep_volume=*/false);
  reader.run();
  Read result{.frames = {}, .statistics = reader.statistics(), .account = board.account()};
  while (auto frame = queue.pop()) result.frames.push_back(std::move(*frame));
  return result;
}

TEST(FrameReader, FramesAreThoseOfAVolumeInEveryMotorMode) {
  for (const hw::MotorMode motor : hw::kMotorModes) {
    const auto plan = hw::small_plan(3, motor);
    const Read got = read(plan, hw::packets_of(plan));
    const int frames = plan.acquisition().frames_per_volume;
    ASSERT_EQ(got.frames.size(), 3u * static_cast<std::size_t>(frames));
    for (std::size_t i = 0; i < got.frames.size(); ++i) {
      const StreamFrame& frame = got.frames[i];
      hw::PolarVolume volume(plan, frame.volume);
      for (int line = 0; line < plan.acquisition().sticks_per_frame; ++line) {
        const hw::StickIndex index{frame.volume,
                                   static_cast<std::uint32_t>(frame.frame),
                                   static_cast<std::uint32_t>(line)};
        volume.place(hw::test_stick(plan, plan.sequence(index)));
      }
      EXPECT_EQ(frame.samples.samples, volume.frame(frame.frame).samples);
      EXPECT_EQ(frame.volume, i / static_cast<std::size_t>(frames));
      EXPECT_EQ(frame.ends_volume, (i + 1) % static_cast<std::size_t>(frames) == 0);
      const bool back = plan.sweep_direction(frame.volume) < 0;
      const int place = static_cast<int>(i) % frames;
      EXPECT_EQ(frame.frame, back ? frames - 1 - place : place);
    }
  }
}

TEST(FrameReader, SaysHowFarTimesLeaveThePlan) {
  const auto plan = hw::small_plan(2);
  const auto off_plan_s = [&](double later_s, std::uint64_t from) {
    std::vector<hw::Bytes> packets;
    for (const hw::Bytes& bytes : hw::packets_of(plan)) {
      hw::Bytes packet = bytes;
      hw::PacketStamp stamp = hw::packet_stamp(packet);
      if (stamp.sequence >= from) {
        stamp.time += std::chrono::nanoseconds(std::llround(1e9 * later_s));
        hw::restamp(packet, stamp);
      }
      packets.push_back(std::move(packet));
    }
    return read(plan, packets).statistics.off_plan_s;
  };
  EXPECT_EQ(off_plan_s(0, 0), 0);
  EXPECT_NEAR(off_plan_s(3600, 0), 0, 1e-8) << "a clock that begins elsewhere";
  EXPECT_NEAR(off_plan_s(3600, 7), 3600, 1e-6);
  EXPECT_NEAR(off_plan_s(-0.25, 7), 0.25, 1e-8);
}

/// Any set of sticks lost: each volume but one without any stick has all its frames, and the sticks
/// are those that came.
TEST(FrameReader, LostSticksLeaveNoFrameOut) {
  const auto plan = hw::small_plan(4);
  const auto all = hw::packets_of(plan);
  const auto sticks = static_cast<std::uint64_t>(4 * plan.sticks_per_volume());
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const std::uint64_t one_in = 2 + seed % 6;
    std::set<std::size_t> lost;
    for (std::uint64_t sequence = 1; sequence < sticks; ++sequence) {
      if (hw::hash(seed, sequence) % one_in == 0) lost.insert(hw::packet_index(plan, sequence));
    }
    std::vector<hw::Bytes> packets;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!lost.contains(i)) packets.push_back(all[i]);
    }
    const auto before = hw::HostClock::now();
    const Read got = read(plan, packets);
    std::uint64_t came = 0;
    for (const StreamFrame& frame : got.frames) came += static_cast<std::uint64_t>(frame.sticks);
    EXPECT_EQ(came, sticks - lost.size()) << seed;
    EXPECT_EQ(came, got.account.delivered) << seed;
    EXPECT_EQ(got.statistics.sticks, came) << seed;
    EXPECT_EQ(got.frames.size() % 3, 0u) << seed;
    // Times go forward, of frames without sticks too.
    for (std::size_t i = 0; i < got.frames.size(); ++i) {
      for (const StickTimes& stick : {got.frames[i].first, got.frames[i].last}) {
        EXPECT_LE(before, stick.received) << seed;
        EXPECT_LE(stick.received, stick.acquired) << seed;
        EXPECT_LE(stick.acquired, stick.placed) << seed;
        EXPECT_LE(stick.placed, got.frames[i].complete) << seed;
      }
      EXPECT_LE(got.frames[i].first.acquired, got.frames[i].last.acquired) << seed;
      if (i == 0) continue;
      EXPECT_LE(got.frames[i - 1].last.acquired, got.frames[i].first.acquired) << seed;
    }
  }
}

TEST(FrameReader, AVolumeWhoseBeginningWasMissedIsLeft) {
  const auto plan = hw::small_plan(2);
  auto packets = hw::packets_of(plan);
  packets.erase(packets.begin() + static_cast<std::ptrdiff_t>(hw::packet_index(plan, 0)));
  const Read got = read(plan, packets);
  ASSERT_EQ(got.frames.size(), 3u);
  EXPECT_EQ(got.frames.front().volume, 1u);
  EXPECT_EQ(got.statistics.left_sticks, static_cast<std::uint64_t>(plan.sticks_per_volume() - 1));
}

TEST(FrameReader, TheSameVolumeIsNotLeftWhereTheStreamEndsWithIt) {
  const auto plan = hw::small_plan(1);
  auto packets = hw::packets_of(plan);
  packets.erase(packets.begin() + static_cast<std::ptrdiff_t>(hw::packet_index(plan, 0)));
  const Read got = read(plan, packets);
  ASSERT_EQ(got.frames.size(), 3u);
  EXPECT_TRUE(got.frames.back().ends_volume);
  EXPECT_EQ(got.frames.front().samples.arrived.front(), 0);
  EXPECT_EQ(got.statistics.left_sticks, 0u);
  EXPECT_EQ(got.statistics.volumes, 1u);
}

/// Behind the last volume that is wanted lies its end, or, where that was lost, another's stick.
TEST(FrameReader, ReadsNoFurtherThanTheEventBehindTheLastVolume) {
  const auto plan = hw::small_plan(3);
  auto packets = hw::packets_of(plan);
  EXPECT_EQ(read(plan, packets, 2).statistics.left_sticks, 0u);
  const auto end_of_second =
      static_cast<std::ptrdiff_t>(hw::packet_index(plan, plan.first_sequence(2) - 1) + 1);
  packets.erase(packets.begin() + end_of_second);
  const Read got = read(plan, packets, 2);
  EXPECT_EQ(got.frames.size(), 6u);
  EXPECT_EQ(got.statistics.left_sticks, 1u);
  EXPECT_EQ(got.statistics.ending, "");
}

/// 1 + 20 log10(s) / 60, by hand: 0.1 is a third below full scale.
TEST(FrameReader, LinearEnvelopesAreLogCompressed) {
  const auto plan = hw::small_plan(2);
  std::vector<hw::Bytes> packets;
  hw::encode(hw::configuration_of(plan, 0), packets.emplace_back());
  for (std::uint64_t sequence = 0; sequence < plan.first_sequence(2); ++sequence) {
    hw::Stick stick = hw::test_stick(plan, sequence);
    stick.scale = hw::SampleScale::linear_envelope;
    std::ranges::fill(stick.samples, 0.1f);
    hw::encode(stick, packets.emplace_back());
  }
  const Read got = read(plan, packets);
  ASSERT_EQ(got.frames.size(), 6u);
  for (const StreamFrame& frame : got.frames) {
    for (const float sample : frame.samples.samples) EXPECT_NEAR(sample, 2.0 / 3, 1e-6);
  }
}

/// Joined recordings, of which the first is a part of a volume of the same number.
TEST(FrameReader, AVolumeOfAnotherAcquisitionIsAnotherVolume) {
  const auto plan = hw::small_plan(1);
  auto packets = hw::packets_of(plan);
  const auto whole = packets;
  packets.resize(hw::packet_index(plan, 9) + 1);
  packets.erase(packets.begin() + static_cast<std::ptrdiff_t>(hw::packet_index(plan, 0)));
  packets.insert(packets.end(), whole.begin(), whole.end());
  const Read got = read(plan, packets);
  ASSERT_EQ(got.frames.size(), 3u);
  for (const StreamFrame& frame : got.frames) EXPECT_EQ(frame.sticks, 4);
  EXPECT_EQ(got.statistics.left_sticks, 9u);
}

TEST(FrameReader, AnAcquisitionThatChangesEndsTheStream) {
  const auto plan = hw::small_plan(1);
  hw::AcquisitionOptions other = plan.acquisition();
  other.depth_m *= 2;
  EXPECT_THROW(read({plan.probe(), other}, hw::packets_of(plan)), std::runtime_error);
}

/// What a configuration says of the samples beside their acquisition, each part changed alone.
using Packet = hw::ConfigurationPacket;
constexpr std::array<void (*)(Packet&), 7> kChanges{
    [](Packet& packet) { packet.subject.phantom ^= 0x80; },
    [](Packet& packet) { packet.subject.placement ^= 1; },
    [](Packet& packet) { packet.subject.motion ^= 4; },
    [](Packet& packet) { packet.source = hw::StreamOrigin::hardware; },
    [](Packet& packet) { packet.display_scale.full_scale_db += 3; },
    [](Packet& packet) { packet.display_scale.dynamic_range_db += 3; },
    [](Packet& packet) { packet.display_scale.tgc_db_per_cm_mhz += 0.1; }};

/// Volumes of one body and, from volume `changed` on, of another or on another scale. Each volume's
/// configuration but the first may be lost.
std::vector<hw::Bytes> changing(const hw::AcquisitionPlan& plan,
                                std::uint32_t changed,
                                std::size_t part,
                                const std::set<std::uint32_t>& lost) {
  std::vector<hw::Bytes> packets = hw::packets_of(plan);
  for (std::uint32_t volume = 0; volume < 6; ++volume) {
    hw::ConfigurationPacket packet = hw::configuration_of(plan, volume);
    packet.subject = {11, 12, 13};
    packet.display_scale = {-10, 60, 0.5};
    if (volume >= changed) kChanges[part](packet);
    hw::Bytes& bytes = packets[hw::packet_index(plan, plan.first_sequence(volume)) - 1];
    bytes.clear();
    if (!lost.contains(volume)) hw::encode(packet, bytes);
  }
  return packets;
}

/// The reader ends the stream with the first configuration that differs, wherever it comes: before
/// that every frame is pushed, and none after it.
TEST(FrameReader, ShowsOneSubjectOnOneScale) {
  const auto plan = hw::small_plan(6);
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    const auto at = [&](std::uint64_t i, std::uint64_t n) { return hw::hash(seed, i) % n; };
    const auto changed = static_cast<std::uint32_t>(1 + at(0, 6));  // 6: it does not
    const std::size_t part = at(1, kChanges.size());
    std::set<std::uint32_t> lost;
    for (std::uint32_t volume = 1; volume < 6; ++volume) {
      if (at(2 + volume, 4) == 0) lost.insert(volume);
    }
    std::uint32_t seen = changed;
    while (seen < 6 && lost.contains(seen)) ++seen;

    hw::Board board(
        std::make_unique<hw::MemoryLink>(hw::join(changing(plan, changed, part, lost))));
    board.start();
    VolumeQueue queue({.policy = StreamPolicy::every, .volumes = 64});
    const StreamSource source{
        .board = board, .plan = plan, .name = "test", .configuration = {}, .dynamic_range_db = {}};
    FrameReader reader(source, queue, 0, /*keep_volume=*/false);
    SCOPED_TRACE(std::to_string(seed) + ": part " + std::to_string(part) + " at " +
                 std::to_string(changed));
    bool is_user_error = false, is_failure = false;
    try {
      reader.run();
    } catch (const UserError&) {
      is_user_error = true;
    } catch (const std::runtime_error&) {
      is_failure = true;
    }
    EXPECT_EQ(is_user_error, seen < 6 && part < 4);
    EXPECT_EQ(is_failure, seen < 6 && part >= 4);
    std::uint32_t frames = 0;
    while (queue.pop()) ++frames;
    EXPECT_EQ(frames, 3 * seen);
  }
}

TEST(FrameSource, EachVolumeGoesWholeToOneOfThreeThreads) {
  const auto plan = hw::small_plan(100);
  hw::Board board(std::make_unique<hw::MemoryLink>(hw::join(hw::packets_of(plan))));
  FrameSource frames([&] { return StreamSource{.board = board, .plan = plan, .name = "test"}; });
  std::atomic<int> whole = 0;
  const auto read_all = [&] {
    std::vector<std::pair<std::uint32_t, int>> got;
    const auto take = [&](const StreamFrame& frame) {
      got.emplace_back(frame.volume, frame.frame);
    };
    while (frames.next_volume(take)) {
      whole += got == decltype(got){{got[0].first, 0}, {got[0].first, 1}, {got[0].first, 2}};
      got.clear();
    }
  };
  {
    const std::array<std::jthread, 3> threads{
        std::jthread(read_all), std::jthread(read_all), std::jthread(read_all)};
  }
  EXPECT_EQ(whole, 100);
  EXPECT_EQ(frames.account()->delivered, plan.first_sequence(100));
}

}  // namespace
}  // namespace wobblebench::bench
