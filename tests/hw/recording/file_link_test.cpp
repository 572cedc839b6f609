#include "hw/recording/file_link.h"

#include <gtest/gtest.h>

#include <limits>
#include <thread>

#include "base/options.h"
#include "hw/wire/decoder.h"
#include "tests/hw/support/collect.h"
#include "tests/hw/support/streams.h"
#include "tests/support/expect.h"
#include "tests/support/folder_test.h"

namespace wobblebench::hw {
namespace {

using FileLinks = testing_support::FolderTest;

TEST_F(FileLinks, DeliverTheFilesBytesAtEitherPace) {
  Bytes stream = stream_of(small_plan(2));
  stream[300] ^= std::byte{1};
  for (std::size_t i = 0; i < 50; ++i) stream.push_back(std::byte{7});
  const auto path = write(stream);
  for (const Pace pace : {Pace::asap, Pace::realtime}) {
    FileLink link(path, {.pace = pace});
    EXPECT_EQ(all_bytes(link, 501), stream);
    EXPECT_EQ(link.capabilities().origin, StreamOrigin::recording);
  }
}

TEST_F(FileLinks, RealtimeLastsAsLongAsTheAcquisition) {
  const AcquisitionPlan plan = small_plan(20);
  FileLink link(write(stream_of(plan)), {.pace = Pace::realtime});
  const auto start = HostClock::now();
  all_bytes(link, 65536);
  EXPECT_GE(HostClock::now() - start,
            plan.volume_end_time(19).time_since_epoch() - std::chrono::milliseconds(1));
}

/// A stream of one volume whose configuration says that its times are not known.
Bytes timeless(const AcquisitionPlan& plan) {
  ConfigurationPacket packet = configuration_of(plan, 0);
  packet.knows_times = false;
  Bytes stream;
  encode(packet, stream);
  const Bytes timed = stream_of(plan);
  stream.insert(
      stream.end(), timed.begin() + static_cast<std::ptrdiff_t>(stream.size()), timed.end());
  return stream;
}

TEST_F(FileLinks, RealtimeNeedsTimes) {
  const Bytes stream = timeless(small_plan());
  const auto path = write(stream);
  FileLink asap(path);
  EXPECT_EQ(all_bytes(asap, 501), stream);
  EXPECT_TRUE(holds(
      refusal_of<InvalidOption>([&] { const FileLink refused(path, {.pace = Pace::realtime}); }),
      "pace = realtime: must be asap; the times of this file are not known"));
  // Behind an acquisition that has times it ends the playback.
  Bytes joined = stream_of(small_plan());
  joined.insert(joined.end(), stream.begin(), stream.end());
  FileLink link(write(joined), {.pace = Pace::realtime});
  Bytes bytes(65536);
  ReadResult result;
  while ((result = link.read(bytes, patience())).status == ReadStatus::ok) {
  }
  EXPECT_EQ(result.status, ReadStatus::lost);
  EXPECT_TRUE(holds(link.loss(), "the times of what follows are not known"));
}

/// What follows takes as long as if there had been no pause.
TEST_F(FileLinks, RealtimeStandsWhileCancelled) {
  const AcquisitionPlan plan = small_plan(100);
  FileLink link(write(stream_of(plan)), {.pace = Pace::realtime});
  std::vector<std::byte> first(100);
  ASSERT_EQ(link.read(first, patience()).status, ReadStatus::ok);
  link.cancel();
  ASSERT_EQ(link.read(first, patience()).status, ReadStatus::cancelled);
  std::this_thread::sleep_for(plan.volume_end_time(99).time_since_epoch());
  link.resume();
  const auto start = HostClock::now();
  all_bytes(link, 65536);
  EXPECT_GE(HostClock::now() - start,
            plan.stick_time(99 * 12).time_since_epoch() - std::chrono::milliseconds(1));
}

/// The first repetition has the last number of a volume.
TEST_F(FileLinks, LoopEndsWhereAVolumesNumberWouldWrap) {
  AcquisitionPlan plan = small_plan(1);
  const std::uint32_t last = std::numeric_limits<std::uint32_t>::max();
  Bytes stream;
  encode(configuration_of(plan, last), stream);
  for (std::uint64_t i = 0; i < 12; ++i) {
    encode(test_stick(plan, plan.first_sequence(last) + i), stream);
  }
  Board board(std::make_unique<FileLink>(write(stream), FileLinkOptions{.loop = true}));
  board.start();
  Collected seen;
  const Event end = collect(board, seen);
  EXPECT_EQ(seen.sticks.size(), 12U);
  ASSERT_TRUE(std::holds_alternative<DeviceLost>(end));
  EXPECT_EQ(std::get<DeviceLost>(end).reason, "the loop has come to the last number of a volume");
}

TEST_F(FileLinks, StartAtAVolume) {
  const AcquisitionPlan plan = small_plan(3);
  const auto path = write(stream_of(plan));
  for (const Pace pace : {Pace::asap, Pace::realtime}) {
    FileLink link(path, {.pace = pace, .start_volume = 2});
    Decoder decoder;
    decoder.feed(all_bytes(link, 4096));
    const auto first = decoder.next();
    ASSERT_TRUE(first);
    EXPECT_EQ(std::get<ConfigurationPacket>(*first).volume, 2U);
  }
  const std::string refusal =
      refusal_of<InvalidOption>([&] { FileLink link(path, {.start_volume = 3}); });
  EXPECT_TRUE(holds(refusal, "start_volume = 3: no volume of "));
  EXPECT_TRUE(holds(refusal, "whose last is 2"));
}

/// A loop is one endless stream: nothing is lost, numbers and times continue.
TEST_F(FileLinks, LoopContinuesNumbersAndTimes) {
  for (const MotorMode motor : kMotorModes) {
    const AcquisitionPlan plan = small_plan(2, motor);
    Board board(std::make_unique<FileLink>(write(stream_of(plan)), FileLinkOptions{.loop = true}));
    board.start();
    Collected seen;
    while (seen.sticks.size() < 100) ASSERT_TRUE(note(board.next(patience()), seen));
    EXPECT_TRUE(seen.gaps.empty());
    EXPECT_EQ(seen.configurations.size(), 1U);
    for (std::uint64_t i = 0; i < 100; ++i) {
      EXPECT_EQ(seen.sticks[i].sequence, i);
      // The sum of two times, each rounded to a nanosecond.
      EXPECT_LE(std::abs((seen.sticks[i].time - plan.stick_time(i)).count()), 1);
      EXPECT_EQ(seen.sticks[i].samples, test_stick(plan, i % 24).samples);
    }
    EXPECT_EQ(board.account().lost.total(), 0U);
  }
}

TEST_F(FileLinks, LoopOverATruncatedRecordingReportsGaps) {
  const AcquisitionPlan plan = small_plan(2);
  Bytes stream = stream_of(plan);
  stream.resize(stream.size() - 300);
  Board board(std::make_unique<FileLink>(write(stream), FileLinkOptions{.loop = true}));
  board.start();
  Collected seen;
  while (seen.sticks.size() < 60) ASSERT_TRUE(note(board.next(patience()), seen));
  ASSERT_FALSE(seen.gaps.empty());
  for (const Stick& stick : seen.sticks) {
    EXPECT_EQ(stick.samples, test_stick(plan, stick.sequence % 24).samples);
  }
}

TEST_F(FileLinks, RejectLoopsThatCannotBeRepeated) {
  const auto expect_rejected = [&](const Bytes& stream, const std::string& why) {
    EXPECT_TRUE(holds(
        refusal_of<InvalidOption>([&] { FileLink link(write(stream), {.loop = true}); }), why));
  };
  expect_rejected(stream_of(small_plan(3, MotorMode::alternating)), "an odd number of volumes");
  Bytes two = stream_of(small_plan(1));
  const Bytes other = stream_of(small_plan(1, MotorMode::continuous));
  two.insert(two.end(), other.begin(), other.end());
  expect_rejected(two, "several acquisitions");
  Bytes none;
  encode(VolumeEndPacket{}, none);
  expect_rejected(none, "no configuration");
}

}  // namespace
}  // namespace wobblebench::hw
