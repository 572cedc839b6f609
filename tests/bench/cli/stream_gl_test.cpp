// The commands stream and latency, by running the program.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

using Json = nlohmann::json;

class StreamCommand : public InFolder {
 protected:
  std::string record(const Words& phantom, const std::string& folder) const {
    const auto result = bench("record --volumes 2 --out " + folder, {kSphere, kScan, phantom});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return bytes_of(at(folder + "/recording.wbst"));
  }
};

TEST_F(StreamCommand, EverySimulatedVolumeIsShownAndMeasured) {
  const auto result =
      bench("stream --board sim --policy every --volumes 6 --errors 3 --trace --out out",
            {kSphere, kScan, kPicture});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = json_of("out/report.json");
  EXPECT_EQ(report["timing"]["latency"]["shown"]["volumes"], 6);
  EXPECT_EQ(report["timing"]["latency"]["shown"]["sticks"], report["timing"]["board"]["delivered"]);
  EXPECT_EQ(report["timing"]["errors"].size(), 3u);
  EXPECT_EQ(report["video"]["codec"], "mjpg");
  // RIFF, AVI.
  const std::string video = bytes_of(at("out/stream.avi"));
  EXPECT_EQ(video.substr(0, 4) + video.substr(8, 4), "RIFFAVI ");
  EXPECT_TRUE(fs::exists(at("out/surface.png")));
}

struct TraceSpan {
  double begin_us, end_us;
  std::string name;
};

/// The spans of each track, in the order of time.
std::map<std::string, std::vector<TraceSpan>> tracks_of(const Json& events) {
  std::map<int, std::string> names;
  std::map<std::string, std::vector<TraceSpan>> tracks;
  for (const Json& event : events) {
    if (event["ph"] == "M") names[event["tid"]] = event["args"]["name"];
  }
  for (const Json& event : events) {
    if (event["ph"] != "X") continue;
    const double begin_us = event["ts"];
    tracks[names.at(event["tid"])].push_back(
        {begin_us, begin_us + double{event["dur"]}, event["name"]});
  }
  for (auto& [track, spans] : tracks) std::ranges::sort(spans, {}, &TraceSpan::begin_us);
  return tracks;
}

/// An end of an arrow, and the span that it lies in.
struct ArrowEnd {
  std::string phase, track;
  TraceSpan span;
};

std::map<int, std::vector<ArrowEnd>> arrows_of(
    const Json& events, const std::map<std::string, std::vector<TraceSpan>>& tracks) {
  std::map<int, std::string> names;
  std::map<int, std::vector<ArrowEnd>> arrows;
  for (const Json& event : events) {
    if (event["ph"] == "M") names[event["tid"]] = event["args"]["name"];
    if (event["ph"] != "s" && event["ph"] != "t" && event["ph"] != "f") continue;
    const std::string track = names.at(event["tid"]);
    const double at_us = event["ts"];
    const auto& spans = tracks.at(track);
    const auto span = std::ranges::find_if(
        spans, [&](const TraceSpan& of) { return of.begin_us <= at_us && at_us <= of.end_us; });
    EXPECT_NE(span, spans.end()) << event;
    if (span != spans.end()) arrows[event["id"]].push_back({event["ph"], track, *span});
  }
  return arrows;
}

/// Spans of a track do not overlap; each arrow goes from a stick by pass 1 to the picture of its
/// volume, or from a picture to the sink, forward in time.
TEST_F(StreamCommand, TheTraceIsOneThatPerfettoOpens) {
  ASSERT_EQ(bench("stream --board sim --policy every --volumes 5 --codec none "
                  "--errors 0 --trace --out out",
                  {kSphere, kScan, kPicture})
                .exit_code,
            0);
  const Json trace = json_of("out/trace.json");
  const Json& events = trace["traceEvents"];
  const auto tracks = tracks_of(events);
  EXPECT_EQ(tracks.size(), 5u);
  for (const auto& [track, spans] : tracks) {
    for (std::size_t i = 1; i < spans.size(); ++i) {
      EXPECT_LE(spans[i - 1].end_us, spans[i].begin_us + 1e-3) << track;
    }
  }
  const int frames = json_of("out/report.json")["scene"]["acquisition"]["frames_per_volume"];
  std::map<std::string, std::vector<double>> counters;
  for (const Json& event : events) {
    if (event["ph"] == "C") counters[event["name"]].push_back(event["args"]["value"]);
  }
  const std::vector<double>& queue = counters.at("frames in the queue");
  ASSERT_EQ(queue.size(), 2u * 5 * frames) << "each frame comes and is taken";
  EXPECT_EQ(queue.back(), 0);
  EXPECT_GE(std::ranges::min(queue), 0);
  EXPECT_EQ(counters.at("age of the newest echo, ms").size(), 5u);
  EXPECT_GT(std::ranges::min(counters.at("age of the oldest echo, ms")), 0);
  int from_sticks = 0, from_pictures = 0;
  for (const auto& [id, ends] : arrows_of(events, tracks)) {
    EXPECT_EQ(ends.front().phase + ends.back().phase, "sf") << id;
    for (std::size_t i = 1; i < ends.size(); ++i) {
      EXPECT_LE(ends[i - 1].span.end_us, ends[i].span.begin_us + 1e-3) << id;
      const std::string& name = ends.back().span.name;
      EXPECT_EQ(ends[i - 1].span.name.substr(0, name.size()), name) << id;
    }
    const bool is_of_stick = ends.front().track == "board: first and last stick of a frame";
    EXPECT_EQ(ends.size(), is_of_stick ? 3u : 2u) << id;
    EXPECT_EQ(ends.back().track, is_of_stick ? "renderer: passes 2 to 4" : "sink: written") << id;
    ++(is_of_stick ? from_sticks : from_pictures);
  }
  EXPECT_EQ(from_sticks, 2 * 5 * frames);
  EXPECT_EQ(from_pictures, 5);
}

/// Frames of 53 ms, after which there is time for a picture.
TEST_F(StreamCommand, PicturesInMidVolumeComeBetweenThoseOfWholeVolumes) {
  const auto result = bench(with({"stream",
                                  "--policy",
                                  "every",
                                  "--volumes",
                                  "3",
                                  "--codec",
                                  "none",
                                  "--trace",
                                  "--set",
                                  "render.pipeline.mid_volume=true",
                                  "--set",
                                  "render.reconstruction.sticks=plain",
                                  "--set",
                                  "render.ray_casting.iso_level=0.72",
                                  "--set",
                                  "acquisition.frames_per_volume=9",
                                  "--set",
                                  "acquisition.sticks_per_frame=256"},
                                 {kSphere, kPicture}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto tracks = tracks_of(json_of("out/trace.json")["traceEvents"]);
  EXPECT_GT(tracks.at("renderer: passes 2 to 4").size(), 6U) << "twice as many as volumes";
  const Json timing = json_of("out/report.json")["timing"];
  EXPECT_EQ(timing["latency"]["shown"]["volumes"], 3);
  EXPECT_EQ(timing["latency"]["shown"]["sticks"], 3 * 9 * 256);
  EXPECT_TRUE(timing["errors"].empty());
  EXPECT_NE(result.out.find("pictures show two volumes (mid_volume)"), std::string::npos)
      << result.out;
}

TEST_F(StreamCommand, CtrlCEndsItWithWholeFiles) {
  ProcessResult result;
  for (std::chrono::milliseconds time(1000); time < std::chrono::minutes(1); time *= 2) {
    ProcessLimits limits;
    limits.interrupt_when = [&] {
      if (!fs::exists(at("out/.wobblebench-partial/stream.avi"))) return false;
      std::this_thread::sleep_for(time);
      return true;
    };
    result = bench("stream --errors 0 --out out", {kSphere, kScan, kPicture}, limits);
    if (result.exit_code == 0) break;
    // The scene was not made, or no picture: again, with more time.
    const bool no_picture = result.exit_code == 1;
    ASSERT_TRUE(no_picture || result.exit_code == 128 + SIGINT)
        << result.exit_code << " " << result.err;
    ASSERT_TRUE(result.err.ends_with(no_picture ? "before the first whole volume was shown\n"
                                                : "wobblebench: interrupted\n"))
        << result.err;
  }
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(
      folder_.files("out"),
      (words_of(
          "ages.csv ages.vl.json report.html report.json spans.vl.json stream.avi surface.png")));
  EXPECT_GT(json_of("out/report.json")["timing"]["latency"]["shown"]["volumes"], 0);
  // RIFF has the length of what follows.
  const std::string bytes = bytes_of(at("out/stream.avi"));
  ASSERT_GT(bytes.size(), 8u);
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 4, 4);
  EXPECT_EQ(length + 8, bytes.size());
}

TEST_F(StreamCommand, CtrlCWhileTheSceneIsMadeLeavesNothing) {
  const auto result =
      bench("stream",
            {},
            {.interrupt_when = [&] { return fs::exists(at("out/.wobblebench-partial")); },
             .no_cache = true});
  expect_line(result, 128 + SIGINT, "wobblebench: interrupted\n");
  EXPECT_FALSE(fs::exists(at("out")));
}

/// Drops are counted by cause; what reached the program is all shown, superseded or left.
TEST_F(StreamCommand, ASmallRingAndALossyLinkAreToldByCause) {
  const auto result = bench(
      "stream --board sim,pace=realtime,faults=drop:0.05 "
      "--ring 4 --volumes 8 --errors 0 --out out",
      {kSphere, kScan, kPicture});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = json_of("out/report.json");
  const Json& board = report["timing"]["board"];
  const std::uint64_t ring_full = board["lost_ring_full"], link = board["lost_link"];
  EXPECT_GT(link, 0u);
  EXPECT_EQ(board["emitted"], std::uint64_t{board["delivered"]} + ring_full + link);
  EXPECT_EQ(report["timing"]["latency"]["ages_from"], "scheduled emission");
  EXPECT_TRUE(report["timing"]["latency"]["spans"]["unknown_because"].is_null());
  EXPECT_LT(double{report["timing"]["latency"]["age_oldest_max_ms"]}, 60000);
  const Json& queues = report["timing"]["queues"];
  const std::uint64_t superseded = std::uint64_t{queues["superseded_before_rendering_sticks"]} +
                                   std::uint64_t{queues["superseded_before_writing_sticks"]};
  EXPECT_EQ(board["delivered"],
            std::uint64_t{report["timing"]["latency"]["shown"]["sticks"]} + superseded +
                std::uint64_t{queues["left_at_the_end_sticks"]} +
                std::uint64_t{queues["not_taken_sticks"]});
}

/// Of one picture each percentile is its value. A fast source and a recording date nothing.
TEST_F(StreamCommand, TheSpansOfAPictureAddUpToTheAgeOfItsNewestEcho) {
  const Words one = words_of("stream --volumes 1 --codec none --errors 0");
  ASSERT_EQ(bench("record --volumes 1 --out rec", {kSphere, kScan}).exit_code, 0);
  for (const std::string board : {"sim,pace=realtime", "sim", "file=rec/recording.wbst"}) {
    SCOPED_TRACE(board);
    const std::string out = "out" + std::to_string(board.size());
    const auto result =
        bench(with(one, {{"--board", board, "--out", out}, kSphere, kScan, kPicture}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const Json latency = json_of(out + "/report.json")["timing"]["latency"];
    const Json& spans = latency["spans"]["newest_echo"];
    const bool is_dated = board == "sim,pace=realtime";
    EXPECT_EQ(spans.front()["p50_ms"].is_null(), !is_dated);
    EXPECT_EQ(latency["spans"]["unknown_because"].is_null(), is_dated);
    double sum_ms = 0;
    for (const Json& span : spans) {
      if (!span["p50_ms"].is_null() && (is_dated || span["from"] != "notified")) {
        sum_ms += double{span["p50_ms"]};
      }
    }
    EXPECT_NEAR(sum_ms, double{latency["age_newest_p50_ms"]}, 1e-2);
  }
}

TEST_F(StreamCommand, ARecordingThatIsShorterThanAskedForIsSaid) {
  ASSERT_EQ(bench("record --volumes 2 --out rec", {kSphere, kScan}).exit_code, 0);
  const auto result = bench(
      "stream --board file=rec/recording.wbst --volumes 5 --policy every --errors 0 --out out",
      {kSphere, kScan, kPicture});
  expect_line(result, 1, "--volumes = 5: --board file=rec/recording.wbst sent 2\n");
  EXPECT_EQ(json_of("out/report.json")["timing"]["latency"]["shown"]["volumes"], 2);
  for (const std::string& text : {result.out, bytes_of(at("out/report.html"))}) {
    EXPECT_FALSE(holds(text, "nan ms")) << "one time between pictures has no spread";
  }
}

TEST_F(StreamCommand, BadInputIsRefusedByOneLine) {
  expect_refusals({{"stream --volumes 0", "--volumes = 0"},
                   {"stream --policy oldest", "--policy: oldest not in {newest,every}"},
                   {"stream --codec vhs", "--codec: vhs not in {mjpg,mp4v,avc1,none}"},
                   {"stream --queue 0", "--queue = 0"},
                   {"latency --policy oldest", "--policy: oldest not in"},
                   {"latency --set render.preset=baseline --set render.pipeline.mid_volume=true",
                    "render.pipeline.mid_volume = true: must be false"}});
  EXPECT_TRUE(folder_.files().empty());
}

TEST_F(StreamCommand, LatencyHoldsVirtualTimeAgainstTheWallClock) {
  const auto result = bench("latency --volumes 10 --out out", {kSphere, kScan, kPicture});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json latency = json_of("out/report.json")["timing"]["latency"];
  EXPECT_EQ(latency["settings"].size(), 5u);
  EXPECT_EQ(latency["stalls"].size(), 3u);
  EXPECT_EQ(latency["crossovers"].size(), 6u);
  for (const Json& setting : latency["settings"]) {
    EXPECT_GT(double{setting["n"]}, 0);
    if (!setting["calibrated_on"]) continue;
    // Drawn from the times of the same streams, whatever else the machine did.
    EXPECT_NEAR(
        double{setting["rendering_virtual_ms"]}, double{setting["rendering_wall_ms"]}, 1e-3);
    EXPECT_NEAR(
        std::log2(double{setting["p50_virtual_ms"]["value"]} / double{setting["p50_wall_ms"]}),
        0,
        2);
  }
  for (const char* file : {"latency.md", "latency_crossover.vl.json", "report.html"}) {
    EXPECT_TRUE(fs::exists(at("out") / file)) << file;
  }
}

TEST_F(StreamCommand, AnotherBodyInTheStreamIsRefusedAndAnotherScaleEndsIt) {
  const std::string sphere = record({}, "sphere");
  folder_.write("bodies.wbst", sphere + record(set("phantom.radius_mm=25"), "other"));
  folder_.write("scales.wbst", sphere + record(set("simulation.full_scale_db=-6"), "scaled"));
  const auto stream = [&](const std::string& file) {
    return bench(with({"stream", "--board", "file=" + file, "--policy", "every", "--out", "out"},
                      {kSphere, kPicture}));
  };
  expect_line(stream("bodies.wbst"), 2, "behind 2 volumes the samples are of another subject");
  EXPECT_FALSE(fs::exists(at("out")));
  expect_line(stream("scales.wbst"), 1, "behind 2 volumes the display scale changes");
  EXPECT_EQ(json_of("out/report.json")["timing"]["latency"]["shown"]["volumes"], 2);
}

TEST_F(StreamCommand, TakesTheReportOfARunAsItsScene) {
  ASSERT_EQ(bench("run --out run", {kSphere, kScan, kPicture}).exit_code, 0);
  const auto again = bench("run run/report.json --out again");
  EXPECT_FALSE(holds(again.err, "without effect")) << again.err;
  const auto result =
      bench("stream run/report.json --volumes 2 --policy every --codec none --errors 0 --out out");
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST_F(StreamCommand, AgesOfSinglePicturesAreThoseOfTheReport) {
  const auto result = bench(
      "stream --board sim,pace=realtime --volumes 5 --policy "
      "every --errors 0 --codec none --out out",
      {kSphere, kScan, kPicture});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  std::istringstream csv(bytes_of(at("out/ages.csv")));
  std::string line;
  std::getline(csv, line);
  Words names;
  std::istringstream head(line);
  for (std::string name; std::getline(head, name, ',');) names.push_back(name);
  const auto column = [&](const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  };
  ASSERT_LT(column("age_newest_ms"), names.size());
  ASSERT_LT(column("ray_casting_ms"), names.size());
  double oldest = 0;
  int lines = 0;
  while (std::getline(csv, line)) {
    std::vector<double> values;
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) values.push_back(std::stod(field));
    ASSERT_EQ(values.size(), names.size());
    EXPECT_EQ(values[column("volume")], lines++);
    const double shown = values[column("shown_ms")];
    EXPECT_NEAR(values[column("age_newest_ms")], shown - values[column("emitted_last_ms")], 2e-3);
    EXPECT_NEAR(values[column("age_oldest_ms")], shown - values[column("emitted_first_ms")], 2e-3);
    EXPECT_LE(values[column("emitted_last_ms")], values[column("arrived_last_ms")]);
    EXPECT_LE(values[column("arrived_last_ms")], values[column("complete_ms")]);
    EXPECT_LE(shown, values[column("written_ms")]);
    oldest = std::max(oldest, values[column("age_oldest_ms")]);
  }
  EXPECT_EQ(lines, 5);
  const Json report = json_of("out/report.json");
  EXPECT_NEAR(report["timing"]["latency"]["age_oldest_max_ms"].get<double>(), oldest, 1e-3);
}

TEST_F(StreamCommand, LossesInAStreamFailWhereThatIsAskedFor) {
  const Words command = with(
      words_of("stream --board sim,faults=drop@20 --volumes 2 --errors 0 --codec none --out out"),
      {kSphere, kScan, kPicture});
  EXPECT_EQ(bench(command).exit_code, 0);
  expect_line(bench(with(command, {{"--fail-on-loss", "--limit", "age_oldest_p50_ms<=1e9"}})),
              1,
              "--fail-on-loss: 1 of 288 sticks were lost");
  EXPECT_TRUE(fs::exists(at("out/surface.png")));
  const Json report = json_of("out/report.json");
  const Json& checks = report["checks"];
  ASSERT_EQ(checks.size(), 3U);
  EXPECT_EQ(checks[0]["held"], true);
  EXPECT_EQ(checks[1]["asked"], "--fail-on-loss");
  EXPECT_EQ(checks[1]["limit"], 0);
  EXPECT_EQ(checks[1]["value"], 1);
  EXPECT_EQ(checks[1]["held"], false);
  EXPECT_EQ(checks[2]["name"], "age_oldest_p50_ms<=1e+09");
  EXPECT_EQ(checks[2]["value"], report["timing"]["latency"]["age_oldest_p50_ms"]);
  EXPECT_EQ(checks[2]["held"], true);
  EXPECT_TRUE(holds(bytes_of(at("out/report.html")), "<strong>Failed</strong>"));
}

}  // namespace
}  // namespace wobblebench::bench
