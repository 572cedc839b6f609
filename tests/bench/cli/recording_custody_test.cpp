// Documented commands destroy no recording: by running the program.
#include <gtest/gtest.h>

#include <array>
#include <csignal>
#include <filesystem>
#include <functional>

#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

/// A folder with rec/recording.wbst of two volumes.
class Custody : public InFolder {
 protected:
  void SetUp() override {
    fs::copy(recorded(2), at("rec"));
    bytes_ = bytes_of(at("rec/recording.wbst"));
  }

  /// Waits until a recording in that folder has so many bytes.
  std::function<bool()> partial_has(const std::string& folder, std::uintmax_t bytes) const {
    return [path = at(folder + "/recording.wbst.partial"), bytes] {
      std::error_code none;
      const auto size = fs::file_size(path, none);
      return !none && size >= bytes;
    };
  }

  /// A killed run's folder: out/recording.wbst.partial.
  void kill_a_recording() {
    ProcessLimits limits;
    limits.signal = SIGKILL;
    limits.interrupt_when = partial_has("out", 100000);
    ASSERT_EQ(
        bench(
            "record --board file=rec/recording.wbst,loop=true,pace=realtime --out out", {}, limits)
            .exit_code,
        128 + SIGKILL);
  }

  std::string bytes_;
};

TEST_F(Custody, SalvageUnderTheFinalNameKeepsItsSource) {
  kill_a_recording();
  const std::string partial = bytes_of(at("out/recording.wbst.partial"));
  const Words salvage = words_of("inspect out/recording.wbst.partial --salvage out/recording.wbst");
  EXPECT_LE(bench(salvage).exit_code, 1);
  EXPECT_EQ(bytes_of(at("out/recording.wbst.partial")), partial);
  EXPECT_EQ(folder_.files("out"), words_of("recording.wbst recording.wbst.partial"));
  EXPECT_EQ(bench("inspect out/recording.wbst").exit_code, 0);
  expect_refused(bench(salvage), "out/recording.wbst: exists; must be a new file");
}

TEST_F(Custody, SalvageRefusesEveryNameThatExists) {
  fs::create_hard_link(at("rec/recording.wbst"), at("hard"));
  fs::create_symlink(at("rec/recording.wbst"), at("soft"));
  fs::create_symlink(at("nowhere"), at("dangling"));
  for (const char* target : {"hard", "soft", "dangling", "rec/recording.wbst"}) {
    expect_refused(bench({"inspect", "rec/recording.wbst", "--salvage", target}),
                   std::string("--salvage = ") + target + ": exists; must be a new file");
  }
  EXPECT_EQ(bytes_of(at("rec/recording.wbst")), bytes_);
}

TEST_F(Custody, AnUnfinishedRecordingIsNeverReplaced) {
  kill_a_recording();
  const std::string partial = bytes_of(at("out/recording.wbst.partial"));
  for (const char* replace : {"", "--replace"}) {
    Words record = words_of("record --board file=rec/recording.wbst --out out");
    if (*replace != 0) record.emplace_back(replace);
    expect_refused(bench(record), "--out = out: holds a recording that was not finished");
  }
  expect_refused(bench("record --board file=out/recording.wbst.partial --out out"),
                 "--out = out: holds a recording that was not finished");
  EXPECT_EQ(bytes_of(at("out/recording.wbst.partial")), partial);
}

TEST_F(Custody, ARecordingIsReplacedOnlyWhenAskedForAndByAnother) {
  const Words record = words_of("record --board file=rec/recording.wbst --out rec");
  expect_refused(bench(record),
                 "--out = rec: holds recording.wbst; must be a folder without one, "
                 "unless --replace is given");
  Words onto_itself = record;
  onto_itself.emplace_back("--replace");
  expect_refused(bench(onto_itself), "--out = rec: its recording.wbst is read by this command");
  EXPECT_EQ(bytes_of(at("rec/recording.wbst")), bytes_);
  fs::copy(at("rec"), at("other"));
  const Words replace =
      words_of("record --board file=rec/recording.wbst --volumes 1 --out other --replace");
  EXPECT_EQ(bench(replace).exit_code, 0);
  EXPECT_EQ(bytes_of(at("other/recording.wbst")), bytes_.substr(0, bytes_.size() / 2));
}

TEST_F(Custody, OfABoardThatSendsNothingNothingIsKept) {
  expect_line(bench("record --board file=rec/recording.wbst,faults=unplug@0 --out new/folder"),
              1,
              "nothing is recorded");
  EXPECT_FALSE(fs::exists(at("new")));
}

TEST_F(Custody, StoppedAtAnyMomentTheRecordingIsUndamaged) {
  for (int i = 0; i < 6; ++i) {
    fs::remove_all(at("out"));
    ProcessLimits limits;
    limits.signal = std::array{SIGINT, SIGTERM, SIGHUP}[static_cast<std::size_t>(i % 3)];
    limits.interrupt_when = partial_has("out", 20000 + 7777 * static_cast<std::uintmax_t>(i));
    const auto stopped = bench(
        "record --board file=rec/recording.wbst,loop=true,pace=realtime --out out", {}, limits);
    EXPECT_EQ(stopped.exit_code, 0) << stopped.err;
    const auto inspected = bench("inspect out/recording.wbst");
    EXPECT_EQ(inspected.exit_code, 0) << inspected.out;
  }
}

TEST_F(Custody, UnpluggedWithinAPacketTheRecordingIsUndamaged) {
  folder_.write("cut.wbst", bytes_.substr(0, bytes_.size() - 100));
  EXPECT_EQ(bench("record --board file=cut.wbst --out out").exit_code, 0);
  EXPECT_EQ(bench("inspect out/recording.wbst").exit_code, 0);
}

TEST_F(Custody, AFolderTakesOneCommandAtATime) {
  ProcessResult second;
  ProcessLimits limits;
  limits.interrupt_when = [&, started = false]() mutable {
    if (!started && partial_has("out", 10000)()) {
      started = true;
      second = bench("record --board file=rec/recording.wbst --out out");
    }
    return started;
  };
  const auto first =
      bench("record --board file=rec/recording.wbst,loop=true,pace=realtime --out out", {}, limits);
  EXPECT_EQ(first.exit_code, 0) << first.err;
  expect_refused(second,
                 "--out = out: is in use by another command; must be a folder that no other "
                 "command writes to");
  EXPECT_EQ(bench("inspect out/recording.wbst").exit_code, 0);
  EXPECT_EQ(folder_.files("out"),
            words_of("recording.json recording.wbst report.html report.json"));
}

TEST_F(Custody, WithStandardStreamsClosedNoTextGetsIntoTheRecording) {
  for (const auto& closed : std::vector<std::vector<int>>{{2}, {1, 2}, {0, 1, 2}}) {
    fs::remove_all(at("out"));
    ProcessLimits limits;
    limits.closed = closed;
    static_cast<void>(bench("record --board file=rec/recording.wbst --out out", {}, limits));
    EXPECT_EQ(bytes_of(at("out/recording.wbst")), bytes_) << closed.size();
  }
}

TEST_F(Custody, ALinkUnderThePartialNameIsNotFollowed) {
  fs::create_directory(at("out"));
  folder_.write("victim", "text");
  fs::create_symlink(at("victim"), at("out/recording.wbst.partial"));
  expect_refused(bench("record --board file=rec/recording.wbst --out out"),
                 "--out = out: holds a recording that was not finished");
  EXPECT_EQ(bytes_of(at("victim")), "text");
}

/// Killed before its first stick: empty, a part of the first packet, the plan alone.
TEST_F(Custody, APartialWithoutAStickIsNoDeadEnd) {
  constexpr std::size_t kHeader = 64, kConfiguration = 64 + 184;  // docs/wire_format.md
  for (const std::size_t bytes : {std::size_t{0}, kHeader - 1, kHeader, kConfiguration}) {
    fs::remove_all(at("out"));
    fs::create_directory(at("out"));
    folder_.write("out/recording.wbst.partial", bytes_.substr(0, bytes));
    expect_line(bench("record --board file=rec/recording.wbst --out out"),
                0,
                "out/recording.wbst.partial of a killed command held no stick");
    EXPECT_EQ(bytes_of(at("out/recording.wbst")), bytes_);
    EXPECT_FALSE(fs::exists(at("out/recording.wbst.partial")));
  }
}

TEST_F(Custody, APartialOfWhichLittleIsKnownStays) {
  std::string later = bytes_;
  later[4] = 9;  // the wire format's version
  for (const std::string& bytes :
       {bytes_.substr(0, 3000), later.substr(0, 3000), std::string(100000, 'x')}) {
    fs::remove_all(at("out"));
    fs::create_directory(at("out"));
    folder_.write("out/recording.wbst.partial", bytes);
    expect_refused(bench("record --board file=rec/recording.wbst --out out"),
                   "--out = out: holds a recording that was not finished");
    EXPECT_EQ(bytes_of(at("out/recording.wbst.partial")), bytes);
  }
}

/// The scene of a recording is known after other commands have filled its folder, too.
TEST_F(Custody, TheReportOfARecordingOutlivesOtherCommands) {
  const std::string report = bytes_of(at("rec/recording.json"));
  EXPECT_TRUE(holds(report, "\"command\": \"record\""));
  ASSERT_EQ(bench("phantom --out rec", {kSphere}).exit_code, 0);
  EXPECT_EQ(bytes_of(at("rec/recording.json")), report);
  EXPECT_EQ(bytes_of(at("rec/recording.wbst")), bytes_);
}

}  // namespace
}  // namespace wobblebench::bench
