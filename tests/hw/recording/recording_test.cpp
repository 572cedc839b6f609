// Inspection and salvage of intact and damaged recordings.
#include "hw/recording/recording.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "hw/recording/file_link.h"
#include "hw/recording/recorder.h"
#include "hw/wire/crc32c.h"
#include "hw/wire/decoder.h"
#include "tests/hw/support/collect.h"
#include "tests/hw/support/memory_link.h"
#include "tests/hw/support/streams.h"
#include "tests/support/expect.h"
#include "tests/support/folder_test.h"

namespace wobblebench::hw {
namespace {

class Recordings : public testing_support::FolderTest {
 protected:
  Bytes salvage(const std::filesystem::path& path) const {
    Bytes kept;
    salvage_recording(path,
                      [&](auto bytes) { kept.insert(kept.end(), bytes.begin(), bytes.end()); });
    return kept;
  }

  /// Salvages a damaged recording of `plan`, and checks that only `touched` sticks are lost of the
  /// first `sent`. Does nothing if the recording holds no configuration.
  void expect_salvaged(const AcquisitionPlan& plan,
                       const Bytes& damaged,
                       const std::set<std::uint64_t>& touched,
                       std::uint64_t sent) const;
};

std::set<std::uint64_t> sticks_in(const AcquisitionPlan& plan, const Bytes& stream) {
  Decoder decoder;
  decoder.feed(stream);
  decoder.finish();
  std::set<std::uint64_t> sequences;
  while (const auto packet = decoder.next()) {
    const auto* stick = std::get_if<StickPacket>(&*packet);
    if (stick == nullptr) continue;
    EXPECT_TRUE(is_genuine(plan, stick->stick)) << stick->stick.sequence;
    sequences.insert(stick->stick.sequence);
  }
  return sequences;
}

void Recordings::expect_salvaged(const AcquisitionPlan& plan,
                                 const Bytes& damaged,
                                 const std::set<std::uint64_t>& touched,
                                 std::uint64_t sent) const {
  const auto path = write(damaged);
  const RecordingContents contents = inspect_recording(path);
  ASSERT_TRUE(contents.account.balanced());
  if (!contents.configuration) return;
  const Bytes kept = salvage(path);
  const auto sticks = sticks_in(plan, kept);
  for (std::uint64_t sequence = 0; sequence < sent; ++sequence) {
    ASSERT_TRUE(sticks.contains(sequence) || touched.contains(sequence)) << sequence;
  }
  if (kept.empty()) return;
  const RecordingContents again = inspect_recording(write(kept, "salvaged.wbst"));
  ASSERT_FALSE(again.damaged());
  ASSERT_EQ(again.unconfigured, 0U);
  ASSERT_EQ(again.account.delivered, sticks.size());
}

TEST_F(Recordings, IntactRecordingIsUndamagedAndComplete) {
  for (const MotorMode motor : kMotorModes) {
    const AcquisitionPlan plan = small_plan(3, motor);
    const auto path = write(stream_of(plan));
    const RecordingContents contents = inspect_recording(path);
    EXPECT_FALSE(contents.damaged());
    EXPECT_TRUE(contents.complete());
    EXPECT_EQ(contents.acquisition_count, 1U);
    EXPECT_EQ(contents.configurations, 3U);
    EXPECT_EQ(contents.sticks, 36U);
    EXPECT_EQ(contents.volume_ends, 3U);
    EXPECT_EQ(contents.account.delivered, 36U);
    ASSERT_EQ(contents.volumes.size(), 3U);
    EXPECT_EQ(contents.volumes[2].sticks, 12U);
    EXPECT_TRUE(contents.volumes[2].closed);
    EXPECT_EQ(salvage(path), stream_of(plan)) << "intact packets are copied byte for byte";
  }
}

TEST_F(Recordings, TruncationAtAnyByteLosesOnlyWhatIsCut) {
  const AcquisitionPlan plan = small_plan(3);
  const Bytes stream = stream_of(plan);
  const auto owner = owners(plan);
  for (std::size_t length = 1; length < stream.size(); ++length) {
    const Bytes cut(stream.begin(), stream.begin() + std::ptrdiff_t(length));
    std::uint64_t whole = 0;
    for (std::size_t i = 0; i < length; ++i) {
      whole += owner[i] >= 0 && owner[i + 1] != owner[i];
    }
    if (length < packets_of(plan)[0].size()) {
      EXPECT_THROW(inspect_recording(write(cut)), LinkOpenError);
      continue;
    }
    expect_salvaged(plan, cut, {}, whole);
    if (HasFatalFailure()) FAIL() << "cut at " << length;
  }
}

TEST_F(Recordings, FlippedBitLosesOnlyItsStick) {
  const AcquisitionPlan plan = small_plan(3);
  const Bytes stream = stream_of(plan);
  const auto owner = owners(plan);
  for (std::uint64_t seed = 0; seed < 10000; ++seed) {
    Bytes damaged = stream;
    const std::size_t bit = hash(seed, 1) % (8 * stream.size());
    damaged[bit / 8] ^= std::byte(1U << (bit % 8));
    std::set<std::uint64_t> touched;
    if (owner[bit / 8] >= 0) touched.insert(static_cast<std::uint64_t>(owner[bit / 8]));
    expect_salvaged(plan, damaged, touched, 36);
    if (HasFatalFailure()) FAIL() << "bit " << bit;
  }
}

TEST_F(Recordings, DamagedFirstConfigurationLosesNoStick) {
  const AcquisitionPlan plan = small_plan(2);
  Bytes stream = stream_of(plan);
  stream[100] ^= std::byte{1};
  const auto path = write(stream);
  const RecordingContents contents = inspect_recording(path);
  EXPECT_TRUE(contents.damaged());
  EXPECT_EQ(contents.unconfigured, 12U);
  EXPECT_EQ(salvage(path), stream_of(plan));
}

TEST_F(Recordings, OfProgramsWithoutADisplayScaleAreReadAndSalvaged) {
  const AcquisitionPlan plan = small_plan(2);
  auto packets = packets_of(plan);
  const std::size_t second = packets.size() / 2;
  for (const std::size_t at : {std::size_t{0}, second}) {
    packets[at] = without_display_scale(packets[at]);
  }
  const RecordingContents contents = inspect_recording(write(join(packets)));
  EXPECT_TRUE(contents.complete());
  EXPECT_FALSE(contents.damaged());
  EXPECT_FALSE(contents.configuration.value().display_scale.stated());
  EXPECT_EQ(contents.account.delivered, 24U);
  packets[second][100] ^= std::byte{1};
  const Bytes kept = salvage(write(join(packets)));
  const RecordingContents again = inspect_recording(write(kept));
  EXPECT_FALSE(again.damaged());
  EXPECT_EQ(again.acquisition_count, 1U) << "configurations of both lengths are equal";
  EXPECT_EQ(again.account.delivered, 24U);
}

TEST_F(Recordings, DamagedRegionsAreLocated) {
  const AcquisitionPlan plan = small_plan(2);
  auto packets = packets_of(plan);
  const std::size_t before = packets[0].size() + 3 * packets[1].size();
  packets[4][70] ^= std::byte{1};
  packets[7] = {};
  const RecordingContents contents = inspect_recording(write(join(packets)));
  ASSERT_EQ(contents.damaged_regions.size(), 1U);
  EXPECT_EQ(contents.damaged_regions[0].offset, before);
  EXPECT_EQ(contents.damaged_regions[0].bytes, packets[4].size());
  ASSERT_EQ(contents.gaps.size(), 2U);
  EXPECT_EQ(contents.gaps[0].cause, LossCause::corrupt);
  EXPECT_EQ(contents.gaps[1].cause, LossCause::link);
  EXPECT_EQ(contents.gaps[1].first_sequence, 6U);
  EXPECT_TRUE(contents.damaged());
}

TEST_F(Recordings, MissingStickIsNoDamage) {
  const AcquisitionPlan plan = small_plan(2);
  auto packets = packets_of(plan);
  packets[5] = {};
  const RecordingContents contents = inspect_recording(write(join(packets)));
  EXPECT_FALSE(contents.damaged());
  EXPECT_FALSE(contents.complete());
  EXPECT_EQ(contents.account.lost.link, 1U);
}

TEST_F(Recordings, ListTheFirst4096GapsAndCountAll) {
  auto packets = packets_of(small_plan(800));
  for (std::size_t i = 1; i < packets.size(); i += 2) packets[i] = {};
  const RecordingContents contents = inspect_recording(write(join(packets)));
  EXPECT_GT(contents.account.lost.link, 4097U);
  EXPECT_EQ(contents.gaps.size(), 4096U);
}

TEST_F(Recordings, SayThatChecksumsAreWrong) {
  auto packets = packets_of(small_plan(1));
  for (Bytes& packet : packets) packet[60] ^= std::byte{1};
  const auto path = write(join(packets));
  EXPECT_EQ(refusal_of<LinkOpenError>([&] { inspect_recording(path); }),
            path.string() +
                ": the checksums of all its packets (14) are wrong; must be CRC-32C "
                "(docs/wire_format.md)");
}

TEST_F(Recordings, RejectsOtherFilesWithTheReason) {
  const auto fault = [](const std::filesystem::path& path) {
    try {
      inspect_recording(path);
    } catch (const LinkOpenError& error) {
      EXPECT_TRUE(holds(error.what(), path.string() + ": "));
      return error.fault();
    }
    ADD_FAILURE() << path << " is accepted";
    return OpenFault::gone;
  };
  EXPECT_EQ(fault(file("none.wbst")), OpenFault::missing);
  EXPECT_EQ(fault(folder_), OpenFault::wrong_kind);
  EXPECT_EQ(fault("/dev/null"), OpenFault::wrong_kind);
  EXPECT_EQ(fault(write({})), OpenFault::empty);
  EXPECT_EQ(fault(write(Bytes(100000, std::byte{'x'}))), OpenFault::foreign);
  Bytes later;
  encode(VolumeEndPacket{}, later);
  later[4] = std::byte{2};
  const std::uint32_t crc = crc32c(std::span<const std::byte>(later).first(60));
  for (std::size_t i = 0; i < 4; ++i) later[60 + i] = std::byte(crc >> (8 * i) & 0xFF);
  EXPECT_EQ(fault(write(later)), OpenFault::later_version);
}

TEST_F(Recordings, HugeLengthIsDamage) {
  Bytes stream = stream_of(small_plan(2));
  Bytes header(stream.begin(), stream.begin() + 64);
  for (std::size_t i = 8; i < 12; ++i) header[i] = std::byte{0xFF};
  stream.insert(stream.begin(), header.begin(), header.end());
  const RecordingContents contents = inspect_recording(write(stream));
  EXPECT_EQ(contents.damage.bytes_skipped, 64U);
  EXPECT_EQ(contents.account.delivered, 24U);
}

TEST_F(Recordings, SparseTerabyteIsReadIncrementally) {
  const auto path = write(stream_of(small_plan(1)));
  std::filesystem::resize_file(path, 1ULL << 40);
  FileLink link(path);
  Board board(std::make_unique<FileLink>(path));
  board.start();
  Collected seen;
  while (seen.sticks.size() < 12) note(board.next(patience()), seen);
  board.close();
}

TEST_F(Recordings, RecorderWritesTheLinksBytes) {
  const AcquisitionPlan plan = small_plan(4);
  for (const std::uint64_t chunks : {0, 1, 2, 3}) {
    MemoryLink link(stream_of(plan), {.chunk_seed = chunks});
    Bytes written;
    Recorder recorder(
        link, [&](auto bytes) { written.insert(written.end(), bytes.begin(), bytes.end()); });
    EXPECT_EQ(recorder.run([] { return false; }), RecordingEnd::end_of_stream);
    EXPECT_EQ(written, stream_of(plan));
    EXPECT_EQ(recorder.progress().volumes, 4U);
    EXPECT_EQ(recorder.progress().account.delivered, 48U);
  }
}

TEST_F(Recordings, BoundedRecordingEndsWithItsLastVolume) {
  const AcquisitionPlan plan = small_plan(4);
  Bytes two;
  const auto packets = packets_of(plan);
  for (std::size_t i = 0; i < 28; ++i) two.insert(two.end(), packets[i].begin(), packets[i].end());
  for (const std::uint64_t chunks : {0, 1, 2, 3}) {
    MemoryLink link(stream_of(plan), {.chunk_seed = chunks});
    Bytes written;
    Recorder recorder(
        link,
        [&](auto bytes) { written.insert(written.end(), bytes.begin(), bytes.end()); },
        {.volumes = 2});
    EXPECT_EQ(recorder.run([] { return false; }), RecordingEnd::volumes);
    EXPECT_EQ(written, two);
    const RecordingContents contents = inspect_recording(write(written));
    EXPECT_TRUE(contents.complete());
  }
}

/// Of 12 sticks a volume, the first with its configuration, and all after stick 24, never come.
TEST_F(Recordings, TheRecorderKnowsHowFarTheSourceCame) {
  auto packets = packets_of(small_plan(3));
  packets.resize(packet_index(small_plan(3), 24) + 1);
  packets.erase(packets.begin(), packets.begin() + 2);
  MemoryLink link(join(packets));
  Recorder recorder(link, [](auto) {});
  EXPECT_EQ(recorder.progress().next_sequence, 0U);
  EXPECT_EQ(recorder.run([] { return false; }), RecordingEnd::end_of_stream);
  EXPECT_EQ(recorder.progress().account.emitted, 24U) << "one more was lost before the first";
  EXPECT_EQ(recorder.progress().next_sequence, 25U);
}

/// Damage that looks like a long packet hides the end of the volume until its bytes have come.
TEST_F(Recordings, BoundedRecordingSurvivesAnEndThatIsSeenLate) {
  const AcquisitionPlan plan = small_plan(100);
  auto packets = packets_of(plan);
  Bytes false_header(packets[1].begin(), packets[1].begin() + 64);
  false_header[6] = std::byte{99};
  false_header[8] = std::byte{0};
  false_header[9] = std::byte{0xFF};
  packets[12].insert(packets[12].end(), false_header.begin(), false_header.end());
  const Bytes stream = join(packets);
  for (const std::uint64_t chunks : {1, 2, 3}) {
    MemoryLink link(stream, {.chunk_seed = chunks});
    Bytes written;
    Recorder recorder(
        link,
        [&](auto bytes) { written.insert(written.end(), bytes.begin(), bytes.end()); },
        {.volumes = 1});
    EXPECT_EQ(recorder.run([] { return false; }), RecordingEnd::volumes);
    EXPECT_LT(written.size(), 75000U);
    ASSERT_LE(written.size(), stream.size());
    EXPECT_TRUE(std::equal(written.begin(), written.end(), stream.begin()));
    EXPECT_EQ(recorder.progress().account.delivered, 12U);
  }
}

TEST_F(Recordings, ExceptionOfTheSinkEndsTheRecording) {
  const AcquisitionPlan plan = small_plan(4);
  MemoryLink link(stream_of(plan), {.chunk_seed = 1});
  Bytes written;
  Recorder recorder(link, [&](std::span<const std::byte> bytes) {
    if (written.size() + bytes.size() > 3000) throw std::runtime_error("no space left");
    written.insert(written.end(), bytes.begin(), bytes.end());
  });
  EXPECT_THROW(static_cast<void>(recorder.run([] { return false; })), std::runtime_error);
  const Bytes stream = stream_of(plan);
  EXPECT_EQ(written, Bytes(stream.begin(), stream.begin() + std::ptrdiff_t(written.size())));
  EXPECT_EQ(recorder.progress().bytes, written.size());
}

}  // namespace
}  // namespace wobblebench::hw
