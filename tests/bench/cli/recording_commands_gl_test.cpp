// record, inspect and run --board, by running the program.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>

#include "base/units.h"
#include "hw/wire/decoder.h"
#include "hw/wire/packet.h"
#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

/// A folder with rec/recording.wbst of three volumes.
class WithRecording : public testing::Test {
 protected:
  void SetUp() override {
    const auto result =
        bench(with({"record", "--volumes", "3", "--out", "rec"}, {kSphere, kScan}), folder_);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    ASSERT_EQ(folder_.files("rec"),
              (Words{"recording.json", "recording.wbst", "report.html", "report.json"}));
  }

  ScratchFolder folder_;
};

TEST_F(WithRecording, InspectSaysThatItIsWhole) {
  const auto result = bench({"inspect", "rec/recording.wbst", "--json"}, folder_);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto report = nlohmann::json::parse(result.out);
  EXPECT_EQ(report.at("recording").at("damaged"), false);
  EXPECT_EQ(report.at("recording").at("complete"), true);
  EXPECT_EQ(report.at("recording").at("volumes").size(), 3U);
  EXPECT_EQ(report.at("board").at("emitted"), 3 * 9 * 16);
  EXPECT_EQ(report.at("board").at("delivered"), 3 * 9 * 16);
  for (const auto& check : report.at("checks")) EXPECT_EQ(check.at("outcome"), "passed");
}

TEST_F(WithRecording, DamagedItFailsAndIsSalvaged) {
  std::string bytes = bytes_of(folder_.path() / "rec/recording.wbst");
  bytes[5000] = static_cast<char>(bytes[5000] ^ 1);
  folder_.write("damaged.wbst", bytes.substr(0, bytes.size() - 100));
  const auto damaged =
      bench({"inspect", "damaged.wbst", "--salvage", "saved.wbst", "--json"}, folder_);
  EXPECT_EQ(damaged.exit_code, 1);
  const auto report = nlohmann::json::parse(damaged.out);
  EXPECT_EQ(report.at("recording").at("damage").size(), 2U) << "a bit, and the cut";
  EXPECT_EQ(report.at("board").at("lost").at("corrupt"), 1);
  const auto saved = bench({"inspect", "saved.wbst"}, folder_);
  EXPECT_EQ(saved.exit_code, 0) << saved.out;
  EXPECT_NE(saved.out.find("undamaged; sticks are missing that never came"), std::string::npos);
}

TEST_F(WithRecording, RenderedItIsTheLiveRunToTheByte) {
  const Words scene = with({}, {kSphere, kPicture});
  const auto live = bench(with({"run", "--register", "--out", "live"}, {scene, kScan}), folder_);
  ASSERT_EQ(live.exit_code, 0) << live.err;
  const auto played = bench(
      with({"run", "--register", "--board", "file=rec/recording.wbst", "--out", "played"}, {scene}),
      folder_);
  ASSERT_EQ(played.exit_code, 0) << played.err;
  for (const char* name : {"surface.png",
                           "volume.png",
                           "error.png",
                           "sheet.png",
                           "depth.exr",
                           "truth_depth.exr",
                           "error_depth.exr"}) {
    EXPECT_EQ(bytes_of(folder_.path() / "live" / name), bytes_of(folder_.path() / "played" / name))
        << name;
  }
  const auto of = [&](const char* run) {
    return nlohmann::json::parse(bytes_of(folder_.path() / run / "report.json"));
  };
  EXPECT_EQ(of("live").at("error"), of("played").at("error"));
  EXPECT_EQ(of("live").at("fit"), of("played").at("fit"));
  EXPECT_EQ(of("live").at("provenance").at("board"), "simulated");
  EXPECT_EQ(of("played").at("provenance").at("board"), "recording");
  EXPECT_EQ(of("played").at("board").at("samples_from"), "simulated");
  EXPECT_TRUE(of("played").at("simulation").is_null());
}

TEST_F(WithRecording, JoinedToItselfItHoldsTwoAcquisitions) {
  const std::string bytes = bytes_of(folder_.path() / "rec/recording.wbst");
  folder_.write("joined.wbst", bytes + bytes);
  const auto inspected = bench({"inspect", "joined.wbst", "--json"}, folder_);
  EXPECT_EQ(inspected.exit_code, 0) << inspected.err;
  const auto recording = nlohmann::json::parse(inspected.out).at("recording");
  ASSERT_EQ(recording.at("acquisition_count"), 2);
  EXPECT_EQ(recording.at("acquisitions").at(1).at("offset"), bytes.size());
  const Words scene = with({}, {kSphere, kPicture});
  const auto warned = bench(with({"run", "--board", "file=joined.wbst"}, {scene}), folder_);
  EXPECT_EQ(warned.exit_code, 0) << warned.err;
  EXPECT_NE(warned.err.find("warning: --board = file=joined.wbst: holds several acquisitions; "),
            std::string::npos)
      << warned.err;
  const auto chosen = bench(
      with({"run", "--board", "file=joined.wbst,acquisition=2,start_volume=1"}, {scene}), folder_);
  EXPECT_EQ(chosen.exit_code, 0) << chosen.err;
  EXPECT_EQ(chosen.err.find("holds several acquisitions"), std::string::npos) << chosen.err;
  const auto copied =
      bench({"record", "--board", "file=joined.wbst,acquisition=2", "--out", "second"}, folder_);
  EXPECT_EQ(copied.exit_code, 0) << copied.err;
  EXPECT_EQ(bytes_of(folder_.path() / "second/recording.wbst"), bytes);
  const auto refused = bench({"conformance", "--board", "file=joined.wbst"}, folder_);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("holds several acquisitions; must be one"), std::string::npos);
}

/// The end of volume 0 comes before any configuration.
TEST_F(WithRecording, WithoutItsFirstConfigurationItIsRenderedFromTheNextVolumeOn) {
  const auto lossy = bench(
      {"record", "--board", "file=rec/recording.wbst,faults=drop@0", "--out", "lossy"}, folder_);
  ASSERT_EQ(lossy.exit_code, 0) << lossy.err;
  const auto result =
      bench(with({"run", "--board", "file=lossy/recording.wbst", "--json"}, {kSphere, kPicture}),
            folder_);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto board = nlohmann::json::parse(result.out).at("board");
  EXPECT_EQ(board.at("volume"), 1);
  EXPECT_EQ(board.at("missing_sticks"), 0);
  EXPECT_EQ(board.at("lost").at("link"), 9 * 16);
}

TEST_F(WithRecording, TablesOfTooFewFramesAreRefused) {
  const auto result = bench({"tables", "--board", "file=rec/recording.wbst"}, folder_);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("has 9 frames a volume; the tables need 37"), std::string::npos)
      << result.err;
}

TEST(Recording, TablesAreMeasuredOnIt) {
  const ScratchFolder folder;
  const Words few_sticks = {"--set", "acquisition.sticks_per_frame=8"};
  ASSERT_EQ(bench(with({"record", "--out", "rec"}, {kSphere, few_sticks}), folder).exit_code, 0);
  const auto result = bench({"tables",
                             "--board",
                             "file=rec/recording.wbst",
                             "--divisor",
                             "8",
                             "--repeats",
                             "1",
                             "--json"},
                            folder);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(folder.files("out"),
            (Words{"report.html",
                   "report.json",
                   "tables.csv",
                   "tables.md",
                   "tables_frames_size.vl.json",
                   "tables_kernels.vl.json"}));
  const auto report = nlohmann::json::parse(result.out);
  EXPECT_EQ(report.at("provenance").at("board"), "recording");
  EXPECT_EQ(report.at("acquisition").at("sticks"), 37 * 8);
  EXPECT_EQ(report.at("scene").at("acquisition").at("sticks_per_frame"), 8);
  EXPECT_EQ(report.at("timing").at("tables").size(), 4u);
}

TEST_F(WithRecording, InjectedFaultsAreCountedInTheReport) {
  const auto result = bench(with({"run",
                                  "--board",
                                  "file=rec/recording.wbst,faults=drop:0.05+corrupt:0.05+seed:2",
                                  "--out",
                                  "faults",
                                  "--json"},
                                 {kSphere, kPicture}),
                            folder_);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto board = nlohmann::json::parse(result.out).at("board");
  auto accounted = board.at("delivered").get<int>();
  for (const auto& [cause, lost] : board.at("lost").items()) accounted += lost.get<int>();
  EXPECT_EQ(board.at("emitted"), accounted);
  EXPECT_GT(board.at("lost").at("link"), 0);
  EXPECT_GT(board.at("lost").at("corrupt"), 0);
  EXPECT_GT(board.at("missing_sticks"), 0);
}

TEST_F(WithRecording, UnpluggedDuringAVolumeItRendersWhatArrivedAndFails) {
  const auto result = bench(
      with({"run", "--board", "file=rec/recording.wbst,faults=unplug@100"}, {kSphere, kPicture}),
      folder_);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("the device is gone (a fault, at packet 100)"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder_.path() / "out/surface.png"));
}

TEST_F(WithRecording, WithFailOnLossLostSticksFail) {
  const std::string board = "file=rec/recording.wbst,faults=drop:0.05+seed:2";
  const auto run = bench(
      with({"run", "--board", board, "--fail-on-loss", "--json"}, {kSphere, kPicture}), folder_);
  EXPECT_EQ(run.exit_code, 1);
  const auto missing = nlohmann::json::parse(run.out).at("board").at("missing_sticks").get<int>();
  EXPECT_GT(missing, 0);
  EXPECT_NE(run.err.find("wobblebench: --fail-on-loss: " + std::to_string(missing) +
                         " of 144 sticks of the volume were lost\n"),
            std::string::npos)
      << run.err;
  EXPECT_TRUE(fs::exists(folder_.path() / "out/surface.png"));
  const auto record =
      bench({"record", "--board", board, "--fail-on-loss", "--out", "again", "--json"}, folder_);
  EXPECT_EQ(record.exit_code, 1);
  const auto lost = nlohmann::json::parse(record.out).at("board").at("lost").at("link").get<int>();
  EXPECT_NE(record.err.find("wobblebench: --fail-on-loss: " + std::to_string(lost) +
                            " of 432 sticks were lost\n"),
            std::string::npos)
      << record.err;
  EXPECT_TRUE(fs::exists(folder_.path() / "again/recording.wbst"));
  const auto whole =
      bench({"record", "--board", "file=rec/recording.wbst", "--fail-on-loss"}, folder_);
  EXPECT_EQ(whole.exit_code, 0) << whole.err;
}

/// The recording with the configurations that `change` makes of its own.
template <class Change>
std::string reconfigured(const std::string& recording, const Change& change) {
  hw::Decoder decoder;
  decoder.feed(std::as_bytes(std::span(recording)));
  std::vector<std::byte> bytes;
  while (auto packet = decoder.next()) {
    if (auto* configuration = std::get_if<hw::ConfigurationPacket>(&*packet)) {
      change(*configuration);
      hw::encode(*configuration, bytes);
    } else if (const auto* stick = std::get_if<hw::StickPacket>(&*packet)) {
      hw::encode(stick->stick, bytes);
    } else {
      hw::encode(std::get<hw::VolumeEndPacket>(*packet), bytes);
    }
  }
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST_F(WithRecording, ARecordingFromHardwareHasNoPhantomAndNoTruth) {
  folder_.write("card.wbst",
                reconfigured(bytes_of(folder_.path() / "rec/recording.wbst"),
                             [](auto& packet) { packet.source = hw::StreamOrigin::hardware; }));
  const auto result =
      bench(with({"run", "--board", "file=card.wbst", "--json"}, {kPicture}), folder_);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err.find("phantom"), std::string::npos) << result.err;
  const auto report = nlohmann::json::parse(result.out);
  EXPECT_TRUE(report.at("error").is_null());
  EXPECT_EQ(report.at("no_truth_because"), "samples from hardware: what they are of is not known");
  EXPECT_TRUE(report.at("scene").at("phantom").is_null());
  const auto& box = report.at("scene").at("render").at("volume_of_interest");
  EXPECT_NEAR(box.at("size_mm").at(0).get<double>(), 400 * std::sin(38.5 * kDegree), 1e-6);
  EXPECT_EQ(folder_.files("out"),
            (Words{"depth.exr",
                   "error.png",
                   "planes.png",
                   "report.html",
                   "report.json",
                   "sheet.png",
                   "surface.png",
                   "volume.png"}));
  const auto summary = bench(with({"run",
                                   "--board",
                                   "file=card.wbst",
                                   "--set",
                                   "render.volume_of_interest.size_mm=[80,80,80]"},
                                  {kPicture}),
                             folder_);
  EXPECT_NE(summary.out.find("truth       none; samples from hardware"), std::string::npos)
      << summary.out;
  const auto registered =
      bench(with({"run", "--register", "--board", "file=card.wbst"}, {kPicture}), folder_);
  EXPECT_EQ(registered.exit_code, 2);
  EXPECT_NE(registered.err.find("--register: needs samples of a known phantom"), std::string::npos)
      << registered.err;
}

TEST_F(WithRecording, AnImpossibleConfigurationKeepsWhatIsBefore) {
  int configurations = 0;
  folder_.write("bad.wbst",
                reconfigured(bytes_of(folder_.path() / "rec/recording.wbst"), [&](auto& packet) {
                  if (++configurations == 3) packet.acquisition.depth_m = -1;
                }));
  const auto inspected = bench({"inspect", "bad.wbst", "--salvage", "s.wbst", "--json"}, folder_);
  EXPECT_EQ(inspected.exit_code, 1) << inspected.err;
  const auto report = nlohmann::json::parse(inspected.out);
  const auto size = fs::file_size(folder_.path() / "bad.wbst");
  const auto& unreadable = report.at("recording").at("unreadable");
  EXPECT_EQ(unreadable.at("offset"), size / 3 * 2);
  EXPECT_EQ(unreadable.at("bytes"), size / 3);
  EXPECT_EQ(report.at("board").at("delivered"), 2 * 9 * 16);
  EXPECT_NE(bench({"inspect", "bad.wbst"}, folder_).out.find("unreadable  from byte"),
            std::string::npos);
  EXPECT_EQ(bench({"inspect", "s.wbst"}, folder_).exit_code, 0);
  EXPECT_EQ(fs::file_size(folder_.path() / "s.wbst"), size / 3 * 2);
  const auto run =
      bench(with({"run", "--board", "file=bad.wbst,start_volume=1"}, {kSphere, kPicture}), folder_);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const auto record = bench({"record", "--board", "file=bad.wbst", "--out", "again"}, folder_);
  EXPECT_EQ(record.exit_code, 1);
  EXPECT_NE(record.err.find("is not possible: depth_mm = -1000: must be within 1 and 400; "),
            std::string::npos)
      << record.err;
  EXPECT_NE(record.err.find("holds 2 whole volumes"), std::string::npos) << record.err;
  EXPECT_EQ(fs::file_size(folder_.path() / "again/recording.wbst.partial"), size / 3 * 2);
}

TEST(Recording, ADeviceThatSendsNoPacketIsGivenUpAndNothingKept) {
  const ScratchFolder folder;
  const std::string line =
      "--board = xdma=/dev/urandom,end_of_packet=false: no sound packet in 64 MiB: this is no "
      "stream of the wire format; nothing is recorded\n";
  const auto record = bench(
      {"record", "--board", "xdma=/dev/urandom,end_of_packet=false", "--volumes", "1"}, folder);
  EXPECT_EQ(record.exit_code, 1);
  EXPECT_EQ(record.err, "wobblebench: " + line);
  EXPECT_TRUE(folder.files("out").empty());
  const auto run = bench({"run", "--board", "xdma=/dev/urandom,end_of_packet=false"}, folder);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("no sound packet in 64 MiB"), std::string::npos) << run.err;
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
}

struct BadBoard {
  std::string name;
  Words arguments;
  std::string message;
};

class BadBoards : public WithRecording, public testing::WithParamInterface<BadBoard> {};

TEST_P(BadBoards, GiveOneLineAndExitTwo) {
  folder_.write("empty.wbst", "");
  folder_.write("foreign.wbst", std::string(5000, 'x'));
  fs::create_directory(folder_.path() / "folder");
  const auto result = bench(GetParam().arguments, folder_);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err.find("wobblebench: "), 0U) << result.err;
  EXPECT_NE(result.err.find(GetParam().message), std::string::npos) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_FALSE(fs::exists(folder_.path() / "out/report.json"));
}

INSTANTIATE_TEST_SUITE_P(
    Each,
    BadBoards,
    testing::Values(
        BadBoard{"none", {"run", "--board", "file=no.wbst"}, "no.wbst: No such file"},
        BadBoard{"folder", {"run", "--board", "file=folder"}, "folder: is a folder"},
        BadBoard{"empty", {"inspect", "empty.wbst"}, "empty.wbst: is empty; must be a recording"},
        BadBoard{"foreign",
                 {"run", "--board", "file=foreign.wbst"},
                 "foreign.wbst: holds no packet of the wire format; must be a recording"},
        BadBoard{"no_device", {"record", "--board", "xdma=/dev/none"}, "/dev/none: No such file"},
        BadBoard{"device_is_a_folder", {"record", "--board", "xdma=folder"}, "folder: "},
        BadBoard{"device_is_a_file",
                 {"run", "--board", "xdma=rec/recording.wbst"},
                 "a recording is opened with file="},
        BadBoard{"path",
                 {"run", "--board", "rec/recording.wbst,pace=realtime"},
                 ": is a path; must be file=rec/recording.wbst"},
        BadBoard{"no_link", {"run", "--board", "usb"}, "--board = usb: must be sim, file="},
        BadBoard{"no_path", {"run", "--board", "file"}, "--board = file: must be file=RECORDING"},
        BadBoard{"no_such_key",
                 {"run", "--board", "sim,colour=red"},
                 "--board = sim,colour=red: colour = red: no such key; sim takes pace, "},
        BadBoard{"no_such_pace",
                 {"run", "--board", "sim,pace=fast"},
                 "pace = fast: must be one of asap, realtime"},
        BadBoard{"no_such_fault",
                 {"run", "--board", "sim,faults=rust:0.1"},
                 "faults = rust:0.1: must be KIND:RATE or KIND@PACKET with one of drop, "},
        BadBoard{"no_such_volume",
                 {"run", "--board", "file=rec/recording.wbst,start_volume=9"},
                 "start_volume = 9: no volume of rec/recording.wbst, whose last is 2"},
        BadBoard{"another_scan",
                 {"run",
                  "--board",
                  "file=rec/recording.wbst",
                  "--set",
                  "acquisition.frames_per_volume=10"},
                 "acquisition.frames_per_volume = 10: --board file=rec/recording.wbst delivers 9"},
        BadBoard{"salvage_onto_itself",
                 {"inspect", "rec/recording.wbst", "--salvage", "rec/recording.wbst"},
                 "--salvage = rec/recording.wbst: exists; must be a new file"}),
    [](const auto& test) { return test.param.name; });

TEST_F(WithRecording, InterruptedARecordingIsWholeAsFarAsItGoes) {
  const fs::path partial = folder_.path() / "long/recording.wbst.partial";
  ProcessLimits limits;
  limits.interrupt_when = [&] {
    std::error_code none;
    const auto size = fs::file_size(partial, none);
    return !none && size > 300000;
  };
  const auto result = bench({"record",
                             "--board",
                             "file=rec/recording.wbst,loop=true,pace=realtime",
                             "--out",
                             "long",
                             "--json"},
                            folder_,
                            limits);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto report = nlohmann::json::parse(result.out);
  EXPECT_EQ(report.at("recording").at("ended_because"), "interrupted");
  EXPECT_GT(report.at("board").at("delivered"), 100);
  EXPECT_EQ(folder_.files("long"),
            (Words{"recording.json", "recording.wbst", "report.html", "report.json"}));
}

TEST_F(WithRecording, AFullDiskKeepsWhatWasRecordedAndSaysWhere) {
  ProcessLimits limits;
  limits.file_bytes = 400000;
  limits.no_cache = true;
  const auto result = bench(
      {"record", "--board", "file=rec/recording.wbst,loop=true", "--volumes", "9", "--out", "full"},
      folder_,
      limits);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("recording.wbst.partial: cannot be written: File too large; it holds 1 "
                            "whole volumes"),
            std::string::npos)
      << result.err;
  const auto salvaged =
      bench({"inspect", "full/recording.wbst.partial", "--salvage", "s.wbst"}, folder_);
  EXPECT_EQ(bench({"inspect", "s.wbst"}, folder_).exit_code, 0);
}

/// The driver of the card: by FUSE where it can be mounted, and by a FIFO anywhere.
TEST(EmulatedDriver, Conforms) {
  const ScratchFolder folder;
  const auto conformance = [&](const std::string& board) {
    return bench(with({"conformance", "--board", board}, {kSphere, kScan}), folder);
  };
  const auto fifo = conformance("xdma=fifo-stand-in");
  EXPECT_EQ(fifo.exit_code, 0) << fifo.out;
  const auto fuse = conformance("xdma=stand-in");
  if (fuse.exit_code == 2) {
    EXPECT_NE(fuse.err.find("needs FUSE"), std::string::npos) << fuse.err;
    GTEST_SKIP() << fuse.err;
  }
  EXPECT_EQ(fuse.exit_code, 0) << fuse.out;
  EXPECT_NE(fuse.out.find("passed  unplug.card"), std::string::npos) << fuse.out;
}

/// Killed at any moment, a recording holds no wrong stick, and what it holds can be salvaged. The
/// start of the program takes most of the time; WOBBLEBENCH_KILLS sets the number of kills.
TEST_F(WithRecording, KilledAtAnyMomentItCanBeSalvaged) {
  const char* setting = std::getenv("WOBBLEBENCH_KILLS");
  const int kills = setting == nullptr ? 20 : std::atoi(setting);
  const fs::path partial = folder_.path() / "killed/recording.wbst.partial";
  for (int kill = 0; kill < kills; ++kill) {
    fs::remove_all(folder_.path() / "killed");
    const auto bytes = static_cast<std::uintmax_t>(1000 + kill * 7919 % 100000);
    ProcessLimits limits;
    limits.signal = SIGKILL;
    limits.interrupt_when = [&] {
      std::error_code none;
      const auto size = fs::file_size(partial, none);
      return !none && size >= bytes;
    };
    const auto killed = bench(
        {"record", "--board", "file=rec/recording.wbst,loop=true,pace=realtime", "--out", "killed"},
        folder_,
        limits);
    ASSERT_EQ(killed.exit_code, 128 + SIGKILL);
    ASSERT_EQ(folder_.files("killed"),
              (Words{".wobblebench-partial", ".wobblebench.lock", "recording.wbst.partial"}));
    fs::remove(folder_.path() / "s.wbst");
    const auto inspected = bench(
        {"inspect", "killed/recording.wbst.partial", "--salvage", "s.wbst", "--json"}, folder_);
    ASSERT_NE(inspected.exit_code, 2) << inspected.err;
    const auto board = nlohmann::json::parse(inspected.out).at("board");
    EXPECT_EQ(board.at("emitted"), board.at("delivered"));
    const auto saved = bench({"inspect", "s.wbst", "--json"}, folder_);
    EXPECT_EQ(saved.exit_code, 0);
    EXPECT_EQ(nlohmann::json::parse(saved.out).at("board").at("delivered"), board.at("delivered"));
  }
}

}  // namespace
}  // namespace wobblebench::bench
