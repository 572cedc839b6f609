// The commands stream and latency, by running the program.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

using Json = nlohmann::json;

class StreamCommand : public testing::Test {
 protected:
  fs::path at(const std::string& name) const { return folder_.path() / name; }
  ProcessResult bench(const Words& arguments, const ProcessLimits& limits = {}) const {
    return run_process(WOBBLEBENCH_PROGRAM, arguments, folder_.path(), limits);
  }
  Json json_of(const std::string& name) const { return Json::parse(bytes_of(at(name))); }
  void expect_refused(const Words& arguments, const std::string& text) const {
    const ProcessResult result = bench(arguments);
    EXPECT_EQ(result.exit_code, 2) << text;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_NE(result.err.find(text), std::string::npos) << result.err;
  }

  ScratchFolder folder_;
};

TEST_F(StreamCommand, EverySimulatedVolumeIsShownAndMeasured) {
  const auto result = bench(with({"stream",
                                  "--board",
                                  "sim",
                                  "--policy",
                                  "every",
                                  "--volumes",
                                  "6",
                                  "--errors",
                                  "3",
                                  "--trace",
                                  "--out",
                                  "out"},
                                 {kSphere, kScan, kPicture}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = json_of("out/report.json");
  EXPECT_EQ(report["latency"]["shown"]["volumes"], 6);
  EXPECT_EQ(report["latency"]["shown"]["sticks"], report["board"]["delivered"]);
  EXPECT_EQ(report["errors"].size(), 3u);
  EXPECT_EQ(report["video"]["codec"], "mjpg");
  // RIFF, AVI.
  const std::string video = bytes_of(at("out/stream.avi"));
  EXPECT_EQ(video.substr(0, 4) + video.substr(8, 4), "RIFFAVI ");
  EXPECT_TRUE(fs::exists(at("out/surface.png")));
}

/// Spans of a track do not overlap; each arrow has two ends, forward in time.
TEST_F(StreamCommand, TheTraceIsOneThatPerfettoOpens) {
  ASSERT_EQ(bench(with({"stream",
                        "--board",
                        "sim,pace=realtime",
                        "--volumes",
                        "5",
                        "--codec",
                        "none",
                        "--trace",
                        "--out",
                        "out"},
                       {kSphere, kScan, kPicture}))
                .exit_code,
            0);
  std::map<int, double> ends;
  std::map<int, double> arrows;
  std::map<int, std::vector<std::pair<double, double>>> tracks;
  const Json trace = json_of("out/trace.json");
  for (const Json& event : trace["traceEvents"]) {
    const std::string phase = event["ph"];
    if (phase == "X") tracks[event["tid"]].push_back({event["ts"], event["dur"]});
    if (phase == "s") arrows[event["id"]] = event["ts"];
    if (phase == "f") {
      ASSERT_TRUE(arrows.contains(event["id"]));
      EXPECT_LE(arrows[event["id"]], double{event["ts"]});
      arrows.erase(int{event["id"]});
    }
  }
  EXPECT_TRUE(arrows.empty());
  EXPECT_EQ(tracks.size(), 4u);
  for (auto& [track, spans] : tracks) {
    std::ranges::sort(spans);
    for (std::size_t i = 1; i < spans.size(); ++i) {
      EXPECT_LE(spans[i - 1].first + spans[i - 1].second, spans[i].first + 1e-3) << track;
    }
  }
}

TEST_F(StreamCommand, CtrlCEndsItWithinASecondWithWholeFiles) {
  for (const int after_ms : {700, 1500}) {
    const std::string out = "out" + std::to_string(after_ms);
    ProcessLimits limits;
    limits.interrupt_after = std::chrono::milliseconds(after_ms);
    const auto result =
        bench(with({"stream", "--errors", "0", "--out", out}, {kSphere, kScan, kPicture}), limits);
    if (result.exit_code != 0) {  // before the first picture
      EXPECT_FALSE(fs::exists(at(out + "/report.json")));
      continue;
    }
    const Json report = json_of(out + "/report.json");
    EXPECT_LT(double{report["wall_ms"]["write"]}, 1000);
    EXPECT_TRUE(fs::exists(at(out + "/stream.avi")));
  }
}

/// Drops are counted by cause; what reached the program is all shown, superseded or left.
TEST_F(StreamCommand, ASmallRingAndALossyLinkAreToldByCause) {
  const auto result = bench(with({"stream",
                                  "--board",
                                  "sim,pace=realtime,faults=drop:0.05",
                                  "--ring",
                                  "4",
                                  "--volumes",
                                  "8",
                                  "--errors",
                                  "0",
                                  "--out",
                                  "out"},
                                 {kSphere, kScan, kPicture}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = json_of("out/report.json");
  const Json& board = report["board"];
  const std::uint64_t ring_full = board["lost"]["ring_full"], link = board["lost"]["link"];
  EXPECT_GT(link, 0u);
  EXPECT_EQ(board["emitted"], std::uint64_t{board["delivered"]} + ring_full + link);
  EXPECT_EQ(report["latency"]["ages_from"], "scheduled emission");
  // The echoes of the last stick take its period, 207.8 us; the volume's end flushes the card.
  EXPECT_NEAR(double{report["latency"]["fired_to_announced_ms"]}, 0.2078, 0.01);
  EXPECT_LT(double{report["latency"]["age_oldest_ms"]["max"]}, 60000);
  const Json& dropped = report["latency"]["dropped"];
  const std::uint64_t superseded = std::uint64_t{dropped["superseded_before_rendering"]["sticks"]} +
                                   std::uint64_t{dropped["superseded_before_writing"]["sticks"]};
  EXPECT_EQ(board["delivered"],
            std::uint64_t{report["latency"]["shown"]["sticks"]} + superseded +
                std::uint64_t{dropped["left_at_the_end_sticks"]} +
                std::uint64_t{dropped["not_taken_sticks"]});
}

TEST_F(StreamCommand, ARecordingThatIsShorterThanAskedForIsSaid) {
  ASSERT_EQ(bench(with({"record", "--volumes", "2", "--out", "rec"}, {kSphere, kScan})).exit_code,
            0);
  const auto result = bench(with({"stream",
                                  "--board",
                                  "file=rec/recording.wbst",
                                  "--volumes",
                                  "5",
                                  "--policy",
                                  "every",
                                  "--errors",
                                  "0",
                                  "--out",
                                  "out"},
                                 {kSphere, kScan, kPicture}));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("--volumes = 5: --board file=rec/recording.wbst sent 2\n"),
            std::string::npos)
      << result.err;
  EXPECT_EQ(json_of("out/report.json")["latency"]["shown"]["volumes"], 2);
}

TEST_F(StreamCommand, BadInputIsRefusedByOneLine) {
  expect_refused({"stream", "--volumes", "0"}, "--volumes = 0");
  expect_refused({"stream", "--policy", "oldest"}, "--policy: oldest not in {newest,every}");
  expect_refused({"stream", "--codec", "vhs"}, "--codec: vhs not in {mjpg,mp4v,avc1,none}");
  expect_refused({"stream", "--queue", "0"}, "--queue = 0");
  expect_refused({"latency", "--policy", "oldest"}, "--policy: oldest not in");
  expect_refused(
      {"latency", "--set", "render.preset=paper", "--set", "render.pipeline.mid_volume=true"},
      "render.pipeline.mid_volume = true: must be false");
  EXPECT_TRUE(folder_.files().empty());
}

TEST_F(StreamCommand, LatencyHoldsVirtualTimeAgainstTheWallClock) {
  const auto result =
      bench(with({"latency", "--volumes", "10", "--out", "out"}, {kSphere, kScan, kPicture}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json latency = json_of("out/report.json")["latency"];
  EXPECT_EQ(latency["checks"].size(), 5u);
  EXPECT_EQ(latency["stalls"].size(), 3u);
  EXPECT_EQ(latency["crossovers"].size(), 6u);
  for (const Json& check : latency["checks"])
    EXPECT_GT(double{check["age_newest_ms"]["wall"]["n"]}, 0);
  EXPECT_TRUE(fs::exists(at("out/latency_crossover.png")));
}

}  // namespace
}  // namespace wobblebench::bench
