// Recordings of several acquisitions: joined, cut within a volume, with settings changed on the
// way.
#include <gtest/gtest.h>

#include <optional>

#include "base/options.h"
#include "hw/board/volume_assembly.h"
#include "hw/recording/file_link.h"
#include "hw/recording/recording.h"
#include "tests/hw/support/collect.h"
#include "tests/hw/support/memory_link.h"
#include "tests/hw/support/streams.h"
#include "tests/support/expect.h"
#include "tests/support/folder_test.h"

namespace wobblebench::hw {
namespace {

using JoinedRecordings = testing_support::FolderTest;

Bytes operator+(Bytes first, const Bytes& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

struct Outcome {
  Collected seen;
  BoardAccount account;
};

Outcome outcome_of(std::unique_ptr<Link> link) {
  Board board(std::move(link));
  board.start();
  Outcome outcome;
  EXPECT_TRUE(std::holds_alternative<EndOfStream>(collect(board, outcome.seen)));
  outcome.account = board.account();
  EXPECT_TRUE(outcome.account.balanced());
  return outcome;
}

Outcome outcome_of(const Bytes& stream) {
  return outcome_of(std::make_unique<MemoryLink>(stream, MemoryLinkOptions{.chunk_seed = 3}));
}

std::vector<std::uint64_t> numbers_of(const Collected& seen) {
  std::vector<std::uint64_t> numbers;
  for (const Stick& stick : seen.sticks) numbers.push_back(stick.sequence);
  return numbers;
}

TEST_F(JoinedRecordings, OfOnePlanLoseNoStick) {
  const AcquisitionPlan plan = small_plan(2);
  const Outcome outcome = outcome_of(stream_of(plan) + stream_of(plan));
  EXPECT_EQ(outcome.seen.configurations.size(), 2U);
  ASSERT_EQ(outcome.seen.sticks.size(), 48U);
  for (std::uint64_t i = 0; i < 48; ++i) {
    EXPECT_EQ(outcome.seen.sticks[i].sequence, i % 24);
    EXPECT_TRUE(is_genuine(plan, outcome.seen.sticks[i]));
  }
  EXPECT_EQ(outcome.account.duplicates, 0U);
  EXPECT_EQ(outcome.account.lost.total(), 0U);
}

TEST_F(JoinedRecordings, OfWhichTheFirstIsCutWithinAVolumeMakeSeparateVolumes) {
  const AcquisitionPlan plan = small_plan(1);
  auto packets = packets_of(plan);
  packets.resize(packet_index(plan, 9) + 1);  // 10 of 12 sticks
  Board board(std::make_unique<MemoryLink>(join(packets) + stream_of(plan)));
  board.start();
  VolumeAssembly assembly(board);
  std::vector<int> missing;
  while (const auto volume = assembly.next(patience())) missing.push_back(volume->missing_sticks());
  EXPECT_EQ(missing, (std::vector<int>{2, 0}));
}

TEST_F(JoinedRecordings, AreListedChosenAndSalvaged) {
  const AcquisitionPlan first = small_plan(2);
  AcquisitionOptions shallow = first.acquisition();
  shallow.depth_m = 0.12;
  const AcquisitionPlan second(first.probe(), shallow);
  const Bytes a = stream_of(first), b = stream_of(second);
  const auto path = write(a + b + b);
  const RecordingContents contents = inspect_recording(path);
  EXPECT_TRUE(contents.complete());
  EXPECT_FALSE(contents.damaged());
  ASSERT_EQ(contents.acquisition_count, 3U);
  EXPECT_EQ(contents.acquisitions[1].offset, a.size());
  EXPECT_EQ(contents.acquisitions[2].offset, a.size() + b.size());
  EXPECT_EQ(contents.acquisitions[2].sticks, 24U);
  EXPECT_EQ(contents.acquisitions[2].volumes, 2U);
  EXPECT_EQ(contents.acquisitions[2].configuration.plan.acquisition().depth_m, 0.12);
  ASSERT_EQ(contents.volumes.size(), 6U);
  EXPECT_EQ(contents.volumes[5].acquisition, 3U);
  Bytes kept;
  salvage_recording(path, [&](auto bytes) { kept.insert(kept.end(), bytes.begin(), bytes.end()); });
  EXPECT_EQ(kept, a + b + b);
  for (const Pace pace : {Pace::asap, Pace::realtime}) {
    const Bytes expected[] = {a, b, b};
    for (int number = 1; number <= 3; ++number) {
      FileLink link(path, {.pace = pace, .acquisition = number});
      EXPECT_EQ(all_bytes(link, 501), expected[number - 1]) << number;
    }
    FileLink volume(path, {.pace = pace, .acquisition = 2, .start_volume = 1});
    const auto half = static_cast<std::ptrdiff_t>(b.size() / 2);
    EXPECT_EQ(all_bytes(volume, 501), Bytes(b.begin() + half, b.end()));
  }
  Board looped(std::make_unique<FileLink>(path, FileLinkOptions{.loop = true, .acquisition = 3}));
  looped.start();
  Collected seen;
  while (seen.sticks.size() < 60) ASSERT_TRUE(note(looped.next(patience()), seen));
  for (std::uint64_t i = 0; i < 60; ++i) EXPECT_EQ(seen.sticks[i].sequence, i);
}

TEST_F(JoinedRecordings, RefuseAnAcquisitionThatIsNotThere) {
  const auto path = write(stream_of(small_plan(1)));
  EXPECT_EQ(refusal_of<InvalidOption>([&] { const FileLink link(path, {.acquisition = 2}); }),
            "acquisition = 2: " + path.string() + " holds 1; must be from 1 to 1");
}

/// The first configuration comes behind the end of a volume.
TEST_F(JoinedRecordings, ThatBeginWithinAVolumeAreReadFromTheNextOn) {
  const AcquisitionPlan plan = small_plan(3);
  auto packets = packets_of(plan);
  packets.erase(packets.begin(), packets.begin() + 6);
  const RecordingContents contents = inspect_recording(write(join(packets)));
  ASSERT_EQ(contents.volumes.size(), 3U);
  EXPECT_FALSE(contents.volumes[0].whole());
  EXPECT_FALSE(contents.complete());
  ASSERT_EQ(contents.gaps.size(), 1U) << "adjacent sticks are one gap";
  EXPECT_EQ(contents.gaps[0].count, 7U);
  Board board(std::make_unique<MemoryLink>(join(packets)));
  board.start();
  VolumeAssembly assembly(board);
  ASSERT_TRUE(assembly.wait_for_configuration(patience()));
  const auto volume = assembly.next(patience());
  ASSERT_TRUE(volume);
  EXPECT_EQ(volume->volume_index(), 1U);
  EXPECT_EQ(volume->missing_sticks(), 0);
  while (assembly.next(patience())) {
  }
  EXPECT_EQ(board.account().lost.link, 7U) << "of 12 sticks 5 came before the first packet";
}

/// No stick of an unknown plan is taken for one of the plan that follows.
TEST_F(JoinedRecordings, ThatBeginWithoutAConfigurationDoNotBorrowTheNext) {
  const AcquisitionPlan plan = small_plan(3);
  auto packets = packets_of(plan);
  packets.resize(packets.size() - 1);
  packets.erase(packets.begin(), packets.end() - 8);  // sticks 28 to 35
  const Bytes stream = join(packets) + stream_of(small_plan(1));
  const auto path = write(stream);
  EXPECT_EQ(numbers_of(outcome_of(stream).seen),
            numbers_of(outcome_of(stream_of(small_plan(1))).seen));
  Bytes kept;
  salvage_recording(path, [&](auto bytes) { kept.insert(kept.end(), bytes.begin(), bytes.end()); });
  EXPECT_EQ(kept, stream_of(small_plan(1)));
}

/// A link may deliver a packet late, or twice, by some packets.
TEST_F(JoinedRecordings, AreNotSeenWhereAConfigurationIsLateOrRepeated) {
  const AcquisitionPlan plan = small_plan(2);
  for (std::size_t later = 1; later <= 5; ++later) {
    for (const bool twice : {false, true}) {
      auto packets = packets_of(plan);
      const Bytes configuration = packets[14];
      packets.insert(packets.begin() + 15 + static_cast<std::ptrdiff_t>(later), configuration);
      if (!twice) packets.erase(packets.begin() + 14);
      const Outcome outcome = outcome_of(join(packets));
      EXPECT_EQ(outcome.seen.sticks.size(), 24U);
      EXPECT_EQ(outcome.seen.configurations.size(), 1U);
    }
  }
}

// Properties over random joins: of a stream cut anywhere, with lost packets, of three plans.

/// One packet, as what a receiver must make of it is decided here: by the rules of the wire format
/// alone.
struct Sent {
  std::size_t plan;  ///< index of its plan
  bool is_configuration = false;
  bool is_stick = false;
  std::uint64_t sequence = 0;
  Bytes bytes;
};

AcquisitionPlan plan_of(std::size_t number) {
  AcquisitionOptions acquisition = small_plan(4).acquisition();
  acquisition.depth_m = 0.1 + 0.01 * static_cast<double>(number);
  return {ProbeOptions{}, acquisition};
}

std::vector<Sent> draw_piece(std::uint64_t seed, std::uint64_t piece) {
  const auto draw = [&](std::uint64_t index, std::uint64_t below) {
    return hash(seed * 1000 + piece, index) % below;
  };
  const std::size_t plan = draw(0, 3);
  const auto packets = packets_of(plan_of(plan));
  const std::size_t begin = draw(1, 3) == 0 ? draw(2, packets.size()) : 14 * draw(2, 4);
  const std::size_t end = begin + 1 + draw(3, packets.size() - begin);
  std::vector<Sent> sent;
  std::uint64_t sequence = begin / 14 * 12 + (begin % 14 == 0 ? 0 : begin % 14 - 1);
  for (std::size_t at = begin; at < end; ++at) {
    const bool is_configuration = at % 14 == 0, is_stick = !is_configuration && at % 14 != 13;
    const bool is_lost = draw(10 + at, 20) == 0;
    if (!is_lost) sent.push_back({plan, is_configuration, is_stick, sequence, packets[at]});
    if (is_stick) ++sequence;
  }
  return sent;
}

/// Sticks to be delivered, acquisition by acquisition.
std::vector<std::vector<std::uint64_t>> expected_sticks(const std::vector<Sent>& stream) {
  std::vector<std::vector<std::uint64_t>> acquisitions;
  std::optional<std::size_t> plan;
  std::uint64_t next = 0;
  bool first = true;
  for (const Sent& packet : stream) {
    if (packet.is_configuration &&
        (plan != packet.plan || (packet.sequence < next && next - packet.sequence > 8))) {
      acquisitions.emplace_back();
      // Sticks that an unknown plan numbered further on are of another acquisition.
      if (plan || (packet.sequence < next && next - packet.sequence > 8)) next = packet.sequence;
      plan = packet.plan;
    }
    if (first || packet.sequence > next) next = packet.sequence;
    first = false;
    if (!packet.is_stick || packet.sequence < next) continue;
    if (plan) acquisitions.back().push_back(packet.sequence);
    ++next;
  }
  return acquisitions;
}

/// Those of each acquisition that a board delivers; a configuration begins one.
std::vector<std::vector<std::uint64_t>> delivered(std::unique_ptr<Link> link) {
  Board board(std::move(link));
  board.start();
  std::vector<std::vector<std::uint64_t>> acquisitions;
  for (;;) {
    const Event event = board.next(patience());
    if (std::holds_alternative<Configuration>(event)) acquisitions.emplace_back();
    if (const auto* slot = std::get_if<StickSlot>(&event)) {
      acquisitions.at(acquisitions.size() - 1).push_back((*slot)->sequence);
    }
    if (std::holds_alternative<EndOfStream>(event)) break;
  }
  EXPECT_TRUE(board.account().balanced());
  return acquisitions;
}

TEST_F(JoinedRecordings, OfRandomPiecesComeAsTheirAcquisitions) {
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::vector<Sent> stream;
    for (std::uint64_t piece = 0; piece <= hash(seed, 0) % 4; ++piece) {
      for (Sent& sent : draw_piece(seed, piece)) stream.push_back(std::move(sent));
    }
    Bytes bytes;
    for (const Sent& sent : stream) bytes = std::move(bytes) + sent.bytes;
    if (bytes.empty()) continue;
    const auto expected = expected_sticks(stream);
    ASSERT_EQ(delivered(std::make_unique<MemoryLink>(bytes)), expected);

    const auto path = write(bytes);
    const RecordingContents contents = inspect_recording(path);
    ASSERT_TRUE(contents.account.balanced());
    ASSERT_EQ(contents.acquisitions.size(), expected.size());
    if (expected.empty()) continue;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_EQ(contents.acquisitions[i].sticks, expected[i].size());
      const auto one = delivered(std::make_unique<FileLink>(
          path, FileLinkOptions{.acquisition = static_cast<int>(i) + 1}));
      ASSERT_EQ(one, std::vector<std::vector<std::uint64_t>>{expected[i]})
          << "acquisition " << i + 1;
    }
    Bytes kept;
    salvage_recording(path, [&](auto part) { kept.insert(kept.end(), part.begin(), part.end()); });
    if (kept.empty()) continue;
    const RecordingContents again = inspect_recording(write(kept, "salvaged.wbst"));
    ASSERT_FALSE(again.damaged());
    ASSERT_EQ(again.unconfigured, 0U);
    ASSERT_GE(again.account.delivered, contents.account.delivered);
  }
}

}  // namespace
}  // namespace wobblebench::hw
