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
class WithRecording : public InFolder {
 protected:
  void SetUp() override {
    fs::copy(recorded(3), at("rec"));
    ASSERT_EQ(folder_.files("rec"),
              words_of("recording.json recording.wbst report.html report.json"));
  }
};

TEST_F(WithRecording, InspectSaysThatItIsWhole) {
  const auto report = report_of(bench("inspect rec/recording.wbst --json"));
  EXPECT_EQ(report.at("recording").at("damaged"), false);
  EXPECT_EQ(report.at("recording").at("complete"), true);
  EXPECT_EQ(report.at("recording").at("volumes").size(), 3U);
  EXPECT_EQ(report.at("board").at("emitted"), 3 * 9 * 16);
  EXPECT_EQ(report.at("board").at("delivered"), 3 * 9 * 16);
  for (const auto& check : report.at("checks")) EXPECT_EQ(check.at("held"), true);
}

TEST_F(WithRecording, DamagedItFailsAndIsSalvaged) {
  std::string bytes = bytes_of(at("rec/recording.wbst"));
  bytes[5000] = static_cast<char>(bytes[5000] ^ 1);
  folder_.write("damaged.wbst", bytes.substr(0, bytes.size() - 100));
  const auto damaged = bench("inspect damaged.wbst --salvage saved.wbst --json");
  EXPECT_EQ(damaged.exit_code, 1);
  const auto report = nlohmann::json::parse(damaged.out);
  EXPECT_EQ(report.at("recording").at("damage").size(), 2U) << "a bit, and the cut";
  EXPECT_EQ(report.at("board").at("lost_corrupt"), 1);
  const auto saved = bench("inspect saved.wbst");
  EXPECT_EQ(saved.exit_code, 0) << saved.out;
  EXPECT_TRUE(holds(saved.out, "undamaged; sticks are missing that never came"));
}

TEST_F(WithRecording, RenderedItIsTheLiveRunToTheByte) {
  const Words scene = with({}, {kSphere, kPicture});
  const auto live = bench("run --register --out live", {scene, kScan});
  ASSERT_EQ(live.exit_code, 0) << live.err;
  const auto played = bench("run --register --board file=rec/recording.wbst --out played", {scene});
  ASSERT_EQ(played.exit_code, 0) << played.err;
  for (const std::string& name : words_of("surface.png volume.png error.png sheet.png depth.exr "
                                          "truth_depth.exr error_depth.exr")) {
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

/// Without a word about the sphere, which is not the default phantom, nor about its place.
TEST_F(WithRecording, ItsReportIsItsScene) {
  const std::string set = " --set render.ray_casting.image_size=48";
  const auto live = bench("run --out live" + set, {kSphere, kScan});
  ASSERT_EQ(live.exit_code, 0) << live.err;
  const auto of_report = [&](const char* run) {
    return nlohmann::json::parse(bytes_of(folder_.path() / run / "report.json")).at("error");
  };
  for (const std::string board : {"", " --board file=rec/recording.wbst"}) {
    const auto again = bench("run rec/recording.json --out again" + set + board);
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(of_report("again"), of_report("live")) << board;
  }
  const auto exported = bench("export rec/recording.wbst --to scan.npz");
  EXPECT_EQ(exported.exit_code, 0) << exported.err;
  folder_.write("none.json", R"({"scene": 3})");
  expect_line(bench("run none.json"), 2, "none.json: has no \"scene\"");
}

TEST_F(WithRecording, JoinedToItselfItHoldsTwoAcquisitions) {
  const std::string bytes = bytes_of(at("rec/recording.wbst"));
  folder_.write("joined.wbst", bytes + bytes);
  const auto recording = report_of(bench("inspect joined.wbst --json")).at("recording");
  ASSERT_EQ(recording.at("acquisition_count"), 2);
  EXPECT_EQ(recording.at("acquisitions").at(1).at("offset"), bytes.size());
  const Words scene = with({}, {kSphere, kPicture});
  const auto warned = bench("run --board file=joined.wbst", {scene});
  EXPECT_EQ(warned.exit_code, 0) << warned.err;
  EXPECT_TRUE(
      holds(warned.err, "warning: --board = file=joined.wbst: holds several acquisitions; "));
  const auto chosen = bench("run --board file=joined.wbst,acquisition=2,start_volume=1", {scene});
  EXPECT_EQ(chosen.exit_code, 0) << chosen.err;
  EXPECT_FALSE(holds(chosen.err, "holds several acquisitions"));
  const auto copied = bench("record --board file=joined.wbst,acquisition=2 --out second");
  EXPECT_EQ(copied.exit_code, 0) << copied.err;
  EXPECT_EQ(bytes_of(at("second/recording.wbst")), bytes);
  expect_line(
      bench("conformance --board file=joined.wbst"), 2, "holds several acquisitions; must be one");
}

/// The end of volume 0 comes before any configuration.
TEST_F(WithRecording, WithoutItsFirstConfigurationItIsRenderedFromTheNextVolumeOn) {
  const auto lossy = bench("record --board file=rec/recording.wbst,faults=drop@0 --out lossy");
  ASSERT_EQ(lossy.exit_code, 0) << lossy.err;
  const auto board =
      report_of(bench("run --board file=lossy/recording.wbst --json", {kSphere, kPicture}))
          .at("board");
  EXPECT_EQ(board.at("volume"), 1);
  EXPECT_EQ(board.at("missing_sticks"), 0);
  EXPECT_EQ(board.at("lost_link"), 9 * 16);
}

TEST_F(WithRecording, TablesOfTooFewFramesAreRefused) {
  expect_line(bench("tables --board file=rec/recording.wbst"),
              2,
              "has 9 frames a volume; the tables need 37");
}

using Recording = InFolder;

TEST_F(Recording, TablesAreMeasuredOnIt) {
  const Words few_sticks = set("acquisition.sticks_per_frame=8");
  ASSERT_EQ(bench("record --out rec", {kSphere, few_sticks}).exit_code, 0);
  const auto result =
      bench("tables --board file=rec/recording.wbst --divisor 8 --repeats 1 --json");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(folder_.files("out"),
            words_of("report.html report.json tables.csv tables.md tables_frames_size.vl.json "
                     "tables_kernels.vl.json"));
  const auto report = nlohmann::json::parse(result.out);
  EXPECT_EQ(report.at("provenance").at("board"), "recording");
  EXPECT_EQ(report.at("acquisition").at("sticks"), 37 * 8);
  EXPECT_EQ(report.at("scene").at("acquisition").at("sticks_per_frame"), 8);
  EXPECT_EQ(report.at("timing").at("tables").size(), 4u);
}

TEST_F(WithRecording, InjectedFaultsAreCountedInTheReport) {
  const auto board =
      report_of(bench("run --board file=rec/recording.wbst,faults=drop:0.05+corrupt:0.05+seed:2 "
                      "--out faults --json",
                      {kSphere, kPicture}))
          .at("board");
  auto accounted = board.at("delivered").get<int>();
  for (const char* cause : {"ring_full", "link", "corrupt", "out_of_order"})
    accounted += board.at(std::string("lost_") + cause).get<int>();
  EXPECT_EQ(board.at("emitted"), accounted);
  EXPECT_GT(board.at("lost_link"), 0);
  EXPECT_GT(board.at("lost_corrupt"), 0);
  EXPECT_GT(board.at("missing_sticks"), 0);
}

TEST_F(WithRecording, UnpluggedDuringAVolumeItRendersWhatArrivedAndFails) {
  expect_line(bench("run --board file=rec/recording.wbst,faults=unplug@100", {kSphere, kPicture}),
              1,
              "the device is gone (a fault, at packet 100)");
  EXPECT_TRUE(fs::exists(at("out/surface.png")));
}

TEST_F(WithRecording, WithFailOnLossLostSticksFail) {
  const std::string board = "file=rec/recording.wbst,faults=drop:0.05+seed:2";
  const auto run =
      bench(with({"run", "--board", board, "--fail-on-loss", "--json"}, {kSphere, kPicture}));
  EXPECT_EQ(run.exit_code, 1);
  const auto missing = nlohmann::json::parse(run.out).at("board").at("missing_sticks").get<int>();
  EXPECT_GT(missing, 0);
  EXPECT_TRUE(holds(run.err,
                    "wobblebench: --fail-on-loss: " + std::to_string(missing) +
                        " of 144 sticks of the volume were lost\n"));
  EXPECT_TRUE(fs::exists(at("out/surface.png")));
  const auto record =
      bench({"record", "--board", board, "--fail-on-loss", "--out", "again", "--json"});
  EXPECT_EQ(record.exit_code, 1);
  const auto lost = nlohmann::json::parse(record.out).at("board").at("lost_link").get<int>();
  EXPECT_TRUE(
      holds(record.err,
            "wobblebench: --fail-on-loss: " + std::to_string(lost) + " of 432 sticks were lost\n"));
  EXPECT_TRUE(fs::exists(at("again/recording.wbst")));
  const auto whole = bench("record --board file=rec/recording.wbst --fail-on-loss");
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
  folder_.write("card.wbst", reconfigured(bytes_of(at("rec/recording.wbst")), [](auto& packet) {
                  packet.source = hw::StreamOrigin::hardware;
                }));
  const auto result = bench("run --board file=card.wbst --json", {kPicture});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_FALSE(holds(result.err, "phantom"));
  const auto report = nlohmann::json::parse(result.out);
  EXPECT_TRUE(report.at("error").is_null());
  EXPECT_EQ(report.at("no_truth_because"), "samples from hardware: what they are of is not known");
  EXPECT_TRUE(report.at("scene").at("phantom").is_null());
  const auto& box = report.at("scene").at("render").at("volume_of_interest");
  EXPECT_NEAR(box.at("size_mm").at(0).get<double>(), 400 * std::sin(38.5 * kDegree), 1e-6);
  EXPECT_EQ(folder_.files("out"),
            words_of("depth.exr error.png planes.png report.html report.json sheet.png "
                     "surface.png volume.png"));
  const auto summary = bench(
      "run --board file=card.wbst --set render.volume_of_interest.size_mm=[80,80,80]", {kPicture});
  EXPECT_TRUE(holds(summary.out, "truth       none; samples from hardware"));
  expect_line(bench("run --register --board file=card.wbst", {kPicture}),
              2,
              "--register: needs samples of a known phantom");
}

TEST_F(WithRecording, AnImpossibleConfigurationKeepsWhatIsBefore) {
  int configurations = 0;
  folder_.write("bad.wbst", reconfigured(bytes_of(at("rec/recording.wbst")), [&](auto& packet) {
                  if (++configurations == 3) packet.acquisition.depth_m = -1;
                }));
  const auto inspected = bench("inspect bad.wbst --salvage s.wbst --json");
  EXPECT_EQ(inspected.exit_code, 1) << inspected.err;
  const auto report = nlohmann::json::parse(inspected.out);
  const auto size = fs::file_size(at("bad.wbst"));
  const auto& unreadable = report.at("recording").at("unreadable");
  EXPECT_EQ(unreadable.at("offset"), size / 3 * 2);
  EXPECT_EQ(unreadable.at("bytes"), size / 3);
  EXPECT_EQ(report.at("board").at("delivered"), 2 * 9 * 16);
  EXPECT_TRUE(holds(bench("inspect bad.wbst").out, "unreadable  from byte"));
  EXPECT_EQ(bench("inspect s.wbst").exit_code, 0);
  EXPECT_EQ(fs::file_size(at("s.wbst")), size / 3 * 2);
  const auto run = bench("run --board file=bad.wbst,start_volume=1", {kSphere, kPicture});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const auto record = bench("record --board file=bad.wbst --out again");
  expect_line(record, 1, "is not possible: depth_mm = -1000: must be within 1 and 400; ");
  EXPECT_TRUE(holds(record.err, "holds 2 whole volumes"));
  EXPECT_EQ(fs::file_size(at("again/recording.wbst.partial")), size / 3 * 2);
}

TEST_F(Recording, ADeviceThatSendsNoPacketIsGivenUpAndNothingKept) {
  const std::string line =
      "--board = xdma=/dev/urandom,end_of_packet=false: no sound packet in 64 MiB: this is no "
      "stream of the wire format; nothing is recorded\n";
  const auto record = bench("record --board xdma=/dev/urandom,end_of_packet=false --volumes 1");
  EXPECT_EQ(record.exit_code, 1);
  EXPECT_EQ(record.err, "wobblebench: " + line);
  EXPECT_TRUE(folder_.files("out").empty());
  const auto run = bench("run --board xdma=/dev/urandom,end_of_packet=false");
  expect_line(run, 1, "no sound packet in 64 MiB");
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
}

const std::vector<RefusedLine> kBadBoards = {
    {"run --board file=no.wbst", "no.wbst: No such file"},
    {"run --board file=folder", "folder: is a folder"},
    {"inspect empty.wbst", "empty.wbst: is empty; must be a recording"},
    {"run --board file=foreign.wbst",
     "foreign.wbst: holds no packet of the wire format; must be a recording"},
    {"record --board xdma=/dev/none", "/dev/none: No such file"},
    {"record --board xdma=folder", "folder: "},
    {"run --board xdma=rec/recording.wbst", "a recording is opened with file="},
    {"run --board rec/recording.wbst,pace=realtime",
     ": is a path; must be file=rec/recording.wbst"},
    {"run --board usb", "--board = usb: must be sim, file="},
    {"run --board file", "--board = file: must be file=RECORDING"},
    {"run --board sim,colour=red",
     "--board = sim,colour=red: colour = red: no such key; sim takes pace, "},
    {"run --board sim,pace=fast", "pace = fast: must be one of asap, realtime"},
    {"run --board sim,faults=rust:0.1",
     "faults = rust:0.1: must be KIND:RATE or KIND@PACKET with one of drop, "},
    {"run --board file=rec/recording.wbst,start_volume=9",
     "start_volume = 9: no volume of rec/recording.wbst, whose last is 2"},
    {"run --board file=rec/recording.wbst --set acquisition.frames_per_volume=10",
     "acquisition.frames_per_volume = 10: --board file=rec/recording.wbst delivers 9"},
    {"inspect rec/recording.wbst --salvage rec/recording.wbst",
     "--salvage = rec/recording.wbst: exists; must be a new file"},
};

TEST_F(WithRecording, BadBoardsAreRefusedWithOneLine) {
  folder_.write("empty.wbst", "");
  folder_.write("foreign.wbst", std::string(5000, 'x'));
  fs::create_directory(at("folder"));
  expect_refusals(kBadBoards);
}

TEST_F(WithRecording, InterruptedARecordingIsWholeAsFarAsItGoes) {
  const fs::path partial = at("long/recording.wbst.partial");
  ProcessLimits limits;
  limits.interrupt_when = [&] {
    std::error_code none;
    const auto size = fs::file_size(partial, none);
    return !none && size > 300000;
  };
  const auto report = report_of(
      bench("record --board file=rec/recording.wbst,loop=true,pace=realtime --out long --json",
            {},
            limits));
  EXPECT_EQ(report.at("recording").at("ended_because"), "interrupted");
  EXPECT_GT(report.at("board").at("delivered"), 100);
  EXPECT_EQ(folder_.files("long"),
            words_of("recording.json recording.wbst report.html report.json"));
}

TEST_F(WithRecording, AFullDiskKeepsWhatWasRecordedAndSaysWhere) {
  ProcessLimits limits;
  limits.file_bytes = 400000;
  limits.no_cache = true;
  expect_line(
      bench("record --board file=rec/recording.wbst,loop=true --volumes 9 --out full", {}, limits),
      1,
      "recording.wbst.partial: cannot be written: File too large; it holds 1 "
      "whole volumes");
  const auto salvaged = bench("inspect full/recording.wbst.partial --salvage s.wbst");
  EXPECT_EQ(bench("inspect s.wbst").exit_code, 0);
}

using EmulatedDriver = InFolder;

/// The driver of the card: by FUSE where it can be mounted, and by a FIFO anywhere.
TEST_F(EmulatedDriver, Conforms) {
  const auto conformance = [&](const std::string& board) {
    return bench(with({"conformance", "--board", board}, {kSphere, kScan}));
  };
  const auto fifo = conformance("xdma=fifo-stand-in");
  EXPECT_EQ(fifo.exit_code, 0) << fifo.out;
  const auto fuse = conformance("xdma=stand-in");
  if (fuse.exit_code == 2) {
    EXPECT_TRUE(holds(fuse.err, "needs FUSE"));
    GTEST_SKIP() << fuse.err;
  }
  EXPECT_EQ(fuse.exit_code, 0) << fuse.out;
  EXPECT_TRUE(holds(fuse.out, "passed  unplug.card"));
}

/// Killed at any moment, a recording holds no wrong stick, and what it holds can be salvaged. The
/// start of the program takes most of the time; WOBBLEBENCH_KILLS sets the number of kills.
TEST_F(WithRecording, KilledAtAnyMomentItCanBeSalvaged) {
  const char* setting = std::getenv("WOBBLEBENCH_KILLS");
  const int kills = setting == nullptr ? 8 : std::atoi(setting);
  const fs::path partial = at("killed/recording.wbst.partial");
  for (int kill = 0; kill < kills; ++kill) {
    fs::remove_all(at("killed"));
    const auto bytes = static_cast<std::uintmax_t>(1000 + kill * 7919 % 100000);
    ProcessLimits limits;
    limits.signal = SIGKILL;
    limits.interrupt_when = [&] {
      std::error_code none;
      const auto size = fs::file_size(partial, none);
      return !none && size >= bytes;
    };
    const auto killed = bench(
        "record --board file=rec/recording.wbst,loop=true,pace=realtime --out killed", {}, limits);
    ASSERT_EQ(killed.exit_code, 128 + SIGKILL);
    ASSERT_EQ(folder_.files("killed"),
              words_of(".wobblebench-partial .wobblebench.lock recording.wbst.partial"));
    fs::remove(at("s.wbst"));
    const auto inspected = bench("inspect killed/recording.wbst.partial --salvage s.wbst --json");
    ASSERT_NE(inspected.exit_code, 2) << inspected.err;
    const auto board = nlohmann::json::parse(inspected.out).at("board");
    EXPECT_EQ(board.at("emitted"), board.at("delivered"));
    const auto saved = bench("inspect s.wbst --json");
    EXPECT_EQ(saved.exit_code, 0);
    EXPECT_EQ(nlohmann::json::parse(saved.out).at("board").at("delivered"), board.at("delivered"));
  }
}

}  // namespace
}  // namespace wobblebench::bench
