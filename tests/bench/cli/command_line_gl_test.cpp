// The program: good input, paths of any bytes, interruption.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "render/gl/context.h"
#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

/// Small enough to run in a second or two.
const Words kQuick = with(kSphere, {kPicture, set("acquisition.frames_per_volume=9")});
const Words kResults = words_of(
    "depth.exr error.png error_depth.exr errors.vl.json planes.png regions.vl.json report.html "
    "report.json sheet.png surface.png truth.png truth_depth.exr truth_reason.png volume.png");

using CommandLine = InFolder;

TEST_F(CommandLine, RunWritesItsResultsAndAReportWithTheDocumentedKeys) {
  const auto result = bench("run --json", {kQuick});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(folder_.files("out"), kResults);
  const auto report = nlohmann::json::parse(result.out);
  EXPECT_NEAR(report.at("acquisition").at("volume_time_ms").get<double>(),
              9 * 64 * 2 * 0.16 / 1540 * 1e3,
              1e-5);
  ASSERT_EQ(report.at("timing").at("render").at("passes").size(), 4u);
  for (const auto& pass : report.at("timing").at("render").at("passes"))
    EXPECT_GT(pass.at("ms").get<double>(), 0) << pass;
  for (const char* figure : {"bias_mm", "rms_mm", "p95_mm"}) {
    EXPECT_TRUE(report.at("error").at(figure).is_number()) << figure;
  }
  EXPECT_TRUE(report.at("error").at("missed_percent").is_number());
  EXPECT_TRUE(report.at("error").at("false_percent").is_number());
  const auto& board = report.at("board");
  EXPECT_EQ(board.at("emitted"), 9 * 64);
  auto accounted = board.at("delivered").get<int>();
  for (const char* cause : {"ring_full", "link", "corrupt", "out_of_order"})
    accounted += board.at(std::string("lost_") + cause).get<int>();
  EXPECT_EQ(board.at("emitted"), accounted);
  EXPECT_FALSE(report.at("effects").empty());
  EXPECT_EQ(report.at("provenance").at("board"), "simulated");
  EXPECT_FALSE(report.at("provenance").at("gl_renderer").get<std::string>().empty());
}

TEST_F(CommandLine, RunRegistersWhereItIsAskedTo) {
  const auto report_of = [&](const Words& more) {
    return nlohmann::json::parse(bench("run --json", {kQuick, more}).out);
  };
  const auto plain = report_of({}), registered = report_of({"--register"});
  EXPECT_TRUE(plain.at("fit").at("registration").is_null());
  EXPECT_EQ(plain.at("fit").at("why_not"), "not asked for; --register fits it");
  EXPECT_FALSE(plain.at("timing").at("wall_ms").contains("register"));
  EXPECT_GT(registered.at("fit").at("registration").at("points").get<int>(), 20);
  EXPECT_TRUE(registered.at("timing").at("wall_ms").contains("register"));
}

TEST_F(CommandLine, ARunFromTheCacheIsTheSameRun) {
  const auto run = [&](const std::string& out, const Words& more, const fs::path& cache) {
    const auto result =
        bench(with({"run", "--json", "--out", out}, {kQuick, more}), {.cache_home = cache});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(result.out);
  };
  const fs::path cache = at("cache");
  const nlohmann::json made = {{"phantom", false}, {"tissue_map", false}, {"echoes", false}};
  const nlohmann::json kept = {{"phantom", true}, {"tissue_map", true}, {"echoes", true}};
  EXPECT_EQ(run("without", {"--no-cache"}, cache).at("timing").at("cached"), made);
  EXPECT_FALSE(fs::exists(cache / "wobblebench")) << "the folder itself is the GL's too";
  EXPECT_EQ(run("cold", {}, cache).at("timing").at("cached"), made);
  EXPECT_EQ(run("warm", {}, cache).at("timing").at("cached"), kept);
  EXPECT_EQ(run("anew", {"--no-cache"}, cache).at("timing").at("cached"), made);
  EXPECT_EQ(run("unwritable", {}, "/dev/null").at("timing").at("cached"), made);
  for (const auto& name : kResults) {
    if (name.starts_with("report.")) continue;  // it has times
    for (const char* out : {"cold", "warm", "anew", "unwritable"}) {
      EXPECT_EQ(bytes_of(at(out) / name), bytes_of(at("without") / name)) << out << " " << name;
    }
  }
}

TEST_F(CommandLine, ARecordingFromTheCacheIsTheSameRecording) {
  const Words scene = set("phantom.name=sphere phantom.voxel_mm=2");
  const fs::path cache = at("cache");
  for (const auto& [out, more] : std::map<std::string, Words>{
           {"1 without", {"--no-cache"}}, {"2 cold", {}}, {"3 warm", {}}}) {
    const auto result = bench(with({"record", "--out", out}, {scene, more}), {.cache_home = cache});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(bytes_of(at(out) / "recording.wbst"), bytes_of(at("1 without/recording.wbst")))
        << out;
  }
  EXPECT_EQ(folder_.files("cache/wobblebench").size(), 2U) << "a phantom and its map";
}

TEST_F(CommandLine, PhantomIsReadBackAndScannedTheSame) {
  const Words small = set("phantom.name=sphere phantom.voxel_mm=2");
  const auto made = bench("phantom", {small});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(folder_.files("out"), words_of("phantom.vdb report.html report.json"));
  const auto direct = bench("run --json --out a", {kQuick});
  auto from_file = kQuick;
  from_file[1] = "phantom.name=file";
  const auto read = bench("run --json --out b --set phantom.file=out/phantom.vdb", {from_file});
  ASSERT_EQ(read.exit_code, 0) << read.err;
  EXPECT_EQ(nlohmann::json::parse(direct.out).at("error"),
            nlohmann::json::parse(read.out).at("error"));
}

TEST_F(CommandLine, InterruptionLeavesAllResultsOrNone) {
  int interrupted = 0;
  bool is_done = false;
  for (int ms = 5; !is_done; ms += ms / 2 + 5) {
    const std::string out = "out" + std::to_string(ms);
    const int signal = ms % 2 == 0 ? SIGINT : SIGTERM;
    const auto result = bench(
        with({"run", "--out", out}, {kQuick}),
        {.interrupt_after = std::chrono::milliseconds(ms), .signal = signal, .no_cache = true});
    const auto files = folder_.files(out);
    is_done = result.exit_code == 0;
    EXPECT_TRUE(is_done || result.exit_code == 128 + signal)
        << result.exit_code << " " << result.err;
    EXPECT_TRUE((files.empty() && !is_done) || files == kResults)
        << "after " << ms << " ms: " << testing::PrintToString(files);
    interrupted += !is_done;
  }
  EXPECT_GT(interrupted, 2);
}

TEST_F(CommandLine, AnInterruptedPhantomLeavesNothingWhileItIsWritten) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const auto being_written = [&] {
      return fs::exists(at("out/.wobblebench-partial/phantom.vdb"));
    };
    const auto result =
        bench("phantom",
              {set("phantom.name=sphere phantom.radius_mm=60 phantom.voxel_mm=0.5")},
              {.interrupt_when = being_written, .signal = signal});
    EXPECT_EQ(result.exit_code, 128 + signal) << result.err;
    EXPECT_FALSE(fs::exists(at("out")));
  }
}

TEST_F(CommandLine, AMissingGlFailsBeforeAnyWork) {
  const auto built = render::context_backends();
  if (std::find(built.begin(), built.end(), "egl") == built.end()) GTEST_SKIP() << "no EGL";
  setenv("__EGL_VENDOR_LIBRARY_DIRS", "/nonexistent", 1);
  for (const std::string command : {"run", "tables", "accuracy"}) {
    const auto result = bench(command + " --gl egl");
    expect_line(result, 1, "wobblebench: egl: ");
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(at("out")));
  }
  unsetenv("__EGL_VENDOR_LIBRARY_DIRS");
}

TEST_F(CommandLine, RunReportsTheGlThatRendered) {
  std::string first;
  for (const std::string& gl : render::context_backends()) {
    const auto result = bench("run --json --gl " + gl, {kQuick});
    if (result.exit_code == 1) continue;  // not on this machine
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(nlohmann::json::parse(result.out).at("provenance").at("gl_backend"), gl);
    if (first.empty()) first = gl;
  }
  const auto report = report_of(bench("run --json", {kQuick}));  // --gl auto
  EXPECT_EQ(report.at("provenance").at("gl_backend"), first);
}

TEST_F(CommandLine, ResultsOfAnEarlierRunSurviveAFailedOne) {
  ASSERT_EQ(bench("run", {kQuick}).exit_code, 0);
  const auto failed = bench("run", {kQuick}, {.file_bytes = 500, .no_cache = true});
  EXPECT_EQ(failed.exit_code, 1);
  EXPECT_EQ(folder_.files("out"), kResults);
}

const Words kSmall = with(kSphere, {kPicture, kScan});

using PathsOfAnyBytes = InFolder;

/// JSON cannot hold paths that are no UTF-8.
TEST_F(PathsOfAnyBytes, WorkOrAreOneLine) {
  folder_.write("\xff.toml", "[acquisition]\ndepth_mm = 100\n");
  for (const Words& first : {Words{"run", "--json", "--out", "\xff"},
                             {"run", "--json", "\xff.toml"},
                             {"record", "--json", "--volumes", "1", "--out", "\xfe"},
                             {"run", "--json", "--board", "file=\xfe/recording.wbst"},
                             {"inspect", "--json", "\xfe/recording.wbst"},
                             {"phantom", "--json", "--out", "\xfd"}}) {
    const auto result = bench(with(first, {first[0] == "inspect" ? Words{} : kSmall}));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(nlohmann::json::accept(result.out)) << first[0];
  }
  EXPECT_EQ(folder_.files("\xff"), kResults);
  EXPECT_EQ(folder_.files("\xfd").size(), 3u);
  const auto refused = bench(with({"run", "--board", "file=none\xff"}, {kSmall}));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(refused.err.find("wobblebench: --board = file=none\\xff: "), 0u) << refused.err;
  EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
}

}  // namespace
}  // namespace wobblebench::bench
