// Device times that jump: named by the inspection, and without effect on playback.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "hw/recording/file_link.h"
#include "hw/recording/recording.h"
#include "hw/wire/decoder.h"
#include "tests/hw/support/collect.h"
#include "tests/hw/support/streams.h"
#include "tests/support/folder_test.h"

namespace wobblebench::hw {
namespace {

constexpr std::int64_t kHour_ns = 3'600'000'000'000;

using JumpingTimes = testing_support::FolderTest;

/// The times of all packets from one on are later by `by_ns`, and wrap as 64 bits do.
void add_to_times(std::vector<Bytes>& packets, std::size_t from, std::int64_t by_ns) {
  for (std::size_t i = from; i < packets.size(); ++i) {
    PacketStamp stamp = packet_stamp(packets[i]);
    const auto sum = static_cast<std::uint64_t>(stamp.time.time_since_epoch().count()) +
                     static_cast<std::uint64_t>(by_ns);
    stamp.time = DeviceTime(DeviceDuration(static_cast<std::int64_t>(sum)));
    restamp(packets[i], stamp);
  }
}

std::uint64_t offset_of(const std::vector<Bytes>& packets, std::size_t index) {
  std::uint64_t offset = 0;
  for (std::size_t i = 0; i < index; ++i) offset += packets[i].size();
  return offset;
}

/// Seconds that reading it to its end takes.
double played_s(const std::filesystem::path& path) {
  FileLink link(path, {.pace = Pace::realtime});
  const auto begin = HostClock::now();
  all_bytes(link, 65536);
  return std::chrono::duration<double>(HostClock::now() - begin).count();
}

TEST_F(JumpingTimes, AreNamedAndPlayedByThePlan) {
  const AcquisitionPlan plan = small_plan(20);
  const double plan_s =
      std::chrono::duration<double>(plan.volume_end_time(19).time_since_epoch()).count();
  for (const std::int64_t by_ns : {kHour_ns,
                                   -kHour_ns,
                                   std::int64_t{1} << 32,
                                   -plan.stick_time(50).time_since_epoch().count()}) {
    auto packets = packets_of(plan);
    const std::size_t at = packet_index(plan, 77);
    add_to_times(packets, at, by_ns);
    const auto path = write(join(packets));
    const RecordingContents contents = inspect_recording(path);
    EXPECT_FALSE(contents.damaged());
    ASSERT_EQ(contents.time_jumps.size(), 1U) << by_ns;
    EXPECT_EQ(contents.time_jumps[0].sequence, 77U);
    EXPECT_EQ(contents.time_jumps[0].offset, offset_of(packets, at));
    EXPECT_NEAR(contents.time_jumps[0].later_s, 1e-9 * static_cast<double>(by_ns), 1e-8);
    const double took_s = played_s(path);
    EXPECT_GE(took_s, plan_s - 1e-3);
    EXPECT_LT(took_s, plan_s + 2) << by_ns;
  }
}

TEST_F(JumpingTimes, AreNotSeenWhereSticksAreLostOrTheClockStartsElsewhere) {
  const AcquisitionPlan plan = small_plan(4, MotorMode::fly_back);
  auto packets = packets_of(plan);
  add_to_times(packets, 0, 123456789);
  for (const std::uint64_t sequence : {3U, 12U, 13U, 40U})
    packets[packet_index(plan, sequence)] = {};
  std::erase_if(packets, [](const Bytes& packet) { return packet.empty(); });
  EXPECT_EQ(inspect_recording(write(join(packets))).time_jump_count, 0U);
}

/// By their times some packets would be due in 292 years.
TEST_F(JumpingTimes, OfAnyNumberHaveNoEffectOnPlayback) {
  const AcquisitionPlan plan = small_plan(2);
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    auto packets = packets_of(plan);
    for (std::uint64_t jump = 0; jump < 3; ++jump) {
      add_to_times(packets,
                   hash(seed, 2 * jump) % packets.size(),
                   static_cast<std::int64_t>(hash(seed, 2 * jump + 1)));
    }
    const Bytes stream = join(packets);
    const auto path = write(stream);
    EXPECT_LE(inspect_recording(path).time_jump_count, 3U);
    FileLink link(path, {.pace = Pace::realtime});
    const auto begin = HostClock::now();
    ASSERT_EQ(all_bytes(link, 65536), stream);
    ASSERT_LT(HostClock::now() - begin, std::chrono::seconds(2)) << "seed " << seed;
  }
}

/// Of the second acquisition the clock begins an hour later, or as the first's.
TEST_F(JumpingTimes, BetweenAcquisitionsAreNoPause) {
  const AcquisitionPlan plan = small_plan(2);
  for (const std::int64_t by_ns : {std::int64_t{0}, kHour_ns}) {
    auto packets = packets_of(plan), second = packets;
    add_to_times(second, 0, by_ns);
    packets.insert(packets.end(), second.begin(), second.end());
    const auto path = write(join(packets));
    EXPECT_EQ(inspect_recording(path).time_jump_count, 0U);
    const double took_s = played_s(path);
    const auto one = plan.volume_end_time(1).time_since_epoch();
    EXPECT_GE(took_s, 2 * std::chrono::duration<double>(one).count() - 1e-3);
    EXPECT_LT(took_s, 2);
  }
}

}  // namespace
}  // namespace wobblebench::hw
