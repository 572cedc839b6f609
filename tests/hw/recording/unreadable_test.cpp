// Streams that cannot be interpreted from a packet on: what is before it is kept.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>

#include "base/options.h"
#include "hw/recording/file_link.h"
#include "hw/recording/recorder.h"
#include "hw/recording/recording.h"
#include "hw/wire/crc32c.h"
#include "hw/wire/unreadable_stream.h"
#include "tests/hw/support/collect.h"
#include "tests/hw/support/memory_link.h"
#include "tests/hw/support/streams.h"
#include "tests/support/expect.h"
#include "tests/support/folder_test.h"

namespace wobblebench::hw {
namespace {

struct Unreadable {
  const char* name;
  Bytes packet;
  std::string reason;
};

Unreadable impossible_configuration() {
  ConfigurationPacket packet = configuration_of(small_plan(), 0);
  packet.acquisition.depth_m = -1;
  Unreadable unreadable{"configuration",
                        {},
                        "the device's configuration is not possible: depth_mm = -1000: must be "
                        "within 1 and 400"};
  encode(packet, unreadable.packet);
  return unreadable;
}

Unreadable later_version() {
  Unreadable unreadable{"version", {}, "wire format version 2: this program reads version 1"};
  encode(VolumeEndPacket{}, unreadable.packet);
  unreadable.packet[4] = std::byte{2};
  const std::uint32_t crc = crc32c(std::span<const std::byte>(unreadable.packet).first(60));
  for (std::size_t i = 0; i < 4; ++i) unreadable.packet[60 + i] = std::byte(crc >> (8 * i) & 0xFF);
  return unreadable;
}

class WithRecording : public testing_support::FolderTest {
 protected:
  static Bytes salvaged(const std::filesystem::path& path) {
    Bytes kept;
    salvage_recording(path,
                      [&](auto bytes) { kept.insert(kept.end(), bytes.begin(), bytes.end()); });
    return kept;
  }
};

class UnreadableStreams : public WithRecording, public testing::WithParamInterface<Unreadable> {
 protected:
  /// Three sound volumes, the packet, two more.
  static Bytes late() {
    return join({stream_of(small_plan(3)), GetParam().packet, stream_of(small_plan(2))});
  }
};

TEST_P(UnreadableStreams, InspectionReadsWhatIsBefore) {
  const Bytes sound = stream_of(small_plan(3));
  const RecordingContents contents = inspect_recording(write(late()));
  EXPECT_TRUE(contents.damaged());
  ASSERT_TRUE(contents.unreadable);
  EXPECT_EQ(contents.unreadable->offset, sound.size());
  EXPECT_EQ(contents.unreadable->reason, GetParam().reason);
  EXPECT_EQ(contents.configurations, 3U);
  EXPECT_EQ(contents.account.delivered, 36U);
  EXPECT_EQ(contents.account.lost.total(), 0U);
  EXPECT_EQ(contents.damage.regions, 0U);
  EXPECT_EQ(contents.volumes.size(), 3U);
}

TEST_P(UnreadableStreams, DamageBeforeItIsLocated) {
  const Bytes sound = stream_of(small_plan(3));
  const Bytes rubbish(40, std::byte{7});
  const RecordingContents contents =
      inspect_recording(write(join({sound, rubbish, GetParam().packet})));
  ASSERT_EQ(contents.damaged_regions.size(), 1U);
  EXPECT_EQ(contents.damaged_regions[0].offset, sound.size());
  EXPECT_EQ(contents.damaged_regions[0].bytes, 40U);
  EXPECT_EQ(contents.damage.bytes_skipped, 40U);
  EXPECT_EQ(contents.unreadable.value().offset, sound.size() + 40);
}

TEST_P(UnreadableStreams, SalvageCopiesWhatIsBefore) {
  EXPECT_EQ(salvaged(write(late())), stream_of(small_plan(3)));
}

TEST_P(UnreadableStreams, ABoardDeliversWhatIsBefore) {
  for (const Pace pace : {Pace::asap, Pace::realtime}) {
    Board board(std::make_unique<FileLink>(write(late()), FileLinkOptions{.pace = pace}));
    board.start();
    Collected seen;
    const Event last = collect(board, seen);
    EXPECT_EQ(seen.sticks.size(), 36U);
    ASSERT_TRUE(std::holds_alternative<DeviceLost>(last));
    EXPECT_EQ(std::get<DeviceLost>(last).cause, DeviceLossCause::unreadable);
    EXPECT_EQ(std::get<DeviceLost>(last).reason, GetParam().reason);
  }
}

TEST_P(UnreadableStreams, AVolumeBeforeItCanBeTheFirst) {
  const auto path = write(late());
  FileLink link(path, {.start_volume = 2});
  EXPECT_FALSE(all_bytes(link, 4096).empty());
  EXPECT_THROW(FileLink(path, {.start_volume = 9}), InvalidOption);
  EXPECT_THROW(FileLink(path, {.loop = true}), InvalidOption);
}

TEST_P(UnreadableStreams, TheRecorderGivesTheSinkAllThatIsBefore) {
  const Bytes sound = stream_of(small_plan(3));
  for (std::uint64_t chunks = 0; chunks < 100; ++chunks) {
    MemoryLink link(late(), {.chunk_seed = chunks});
    Bytes written;
    Recorder recorder(
        link, [&](auto bytes) { written.insert(written.end(), bytes.begin(), bytes.end()); });
    EXPECT_THROW(static_cast<void>(recorder.run([] { return false; })), UnreadableStream);
    ASSERT_GE(written.size(), sound.size()) << chunks;
    ASSERT_LT(written.size(), sound.size() + GetParam().packet.size());
    ASSERT_TRUE(std::equal(sound.begin(), sound.end(), written.begin()));
    EXPECT_EQ(recorder.progress().bytes, written.size());
    EXPECT_EQ(recorder.progress().volumes, 3U);
  }
}

INSTANTIATE_TEST_SUITE_P(Packets,
                         UnreadableStreams,
                         testing::Values(impossible_configuration(), later_version()),
                         [](const auto& test) { return test.param.name; });

TEST_F(WithRecording, WithoutASoundConfigurationNothingIsSalvaged) {
  const auto path = write(join({impossible_configuration().packet, stream_of(small_plan(1))}));
  const RecordingContents contents = inspect_recording(path);
  EXPECT_EQ(contents.unreadable.value().offset, 0U);
  EXPECT_EQ(contents.account.emitted, 0U);
  EXPECT_THROW(salvaged(path), std::runtime_error);
}

/// Its plan is good, its number is not: salvaged, the sticks have a configuration of their own.
TEST_F(WithRecording, AConfigurationWithAWrongNumberIsReplaced) {
  const AcquisitionPlan plan = small_plan(2);
  auto packets = packets_of(plan);
  for (const std::size_t which : {0U, 14U}) {
    auto wrong = packets;
    wrong[which].clear();
    ConfigurationPacket packet = configuration_of(plan, which == 0 ? 0 : 1);
    packet.sequence = std::uint64_t{1} << 40U;
    encode(packet, wrong[which]);
    const auto path = write(join(wrong));
    const RecordingContents contents = inspect_recording(path);
    EXPECT_TRUE(contents.damaged());
    EXPECT_EQ(contents.contradictions, 1U);
    EXPECT_EQ(contents.account.delivered, 24U);
    EXPECT_EQ(salvaged(path), stream_of(plan));
  }
}

/// Bytes without a packet, and sound packets after every so many of them.
class RubbishLink : public Link {
 public:
  RubbishLink(Bytes packet, std::uint64_t every, std::uint64_t most)
      : packet_(std::move(packet)), every_(every), most_(most) {}
  ReadResult read(std::span<std::byte> buffer, HostTime) override {
    if (sent_ >= most_) return {0, ReadStatus::end_of_stream};
    const std::uint64_t before = sent_ / every_;
    for (std::size_t i = 0; i < buffer.size(); ++i) {
      buffer[i] = std::byte(hash(1, (sent_ + i) / 8 % 4096) >> 3);
    }
    sent_ += buffer.size();
    if (sent_ / every_ != before) std::copy(packet_.begin(), packet_.end(), buffer.begin());
    return {buffer.size(), ReadStatus::ok};
  }
  void cancel() override {}
  void resume() override {}
  void close() override {}
  LinkCapabilities capabilities() const override { return {}; }
  std::uint64_t sent() const { return sent_; }

 private:
  const Bytes packet_;
  const std::uint64_t every_;
  const std::uint64_t most_;
  std::uint64_t sent_ = 0;
};

constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint64_t kMost = 3 * kMostSkippedBytes;

Bytes a_configuration() {
  Bytes packet;
  encode(configuration_of(small_plan(), 0), packet);
  return packet;
}

TEST(Rubbish, TheRecorderGivesUpADeviceThatSendsNoPacket) {
  RubbishLink link({}, kNever, kMost);
  std::uint64_t written = 0;
  Recorder recorder(link, [&](auto bytes) { written += bytes.size(); });
  EXPECT_EQ(
      refusal_of<UnreadableStream>([&] { static_cast<void>(recorder.run([] { return false; })); }),
      "no sound packet in 64 MiB: this is no stream of the wire format");
  EXPECT_LE(written, kMostSkippedBytes + 65536);
  EXPECT_LE(link.sent(), kMostSkippedBytes + 2 * 65536);
}

TEST(Rubbish, TheBoardGivesUpADeviceThatSendsNoPacket) {
  auto link = std::make_unique<RubbishLink>(Bytes{}, kNever, kMost);
  const RubbishLink& sender = *link;
  Board board(std::move(link));
  board.start();
  Collected seen;
  const Event last = collect(board, seen);
  ASSERT_TRUE(std::holds_alternative<DeviceLost>(last));
  EXPECT_EQ(std::get<DeviceLost>(last).cause, DeviceLossCause::unreadable);
  EXPECT_LE(sender.sent(), kMostSkippedBytes + 2 * 65536);
}

TEST(Rubbish, ADeviceThatIsDamagedNowAndThenIsNotGivenUp) {
  for (const std::uint64_t every : {kMostSkippedBytes / 8, kMostSkippedBytes - (1U << 20)}) {
    RubbishLink link(a_configuration(), every, kMost);
    Recorder recorder(link, [](auto) {});
    EXPECT_EQ(recorder.run([] { return false; }), RecordingEnd::end_of_stream);
    EXPECT_GT(recorder.progress().damage.bytes_skipped, 2 * kMostSkippedBytes);
    Board board(std::make_unique<RubbishLink>(a_configuration(), every, kMost));
    board.start();
    Collected seen;
    EXPECT_TRUE(std::holds_alternative<EndOfStream>(collect(board, seen)));
    EXPECT_EQ(seen.configurations.size(), 1U);
  }
}

}  // namespace
}  // namespace wobblebench::hw
