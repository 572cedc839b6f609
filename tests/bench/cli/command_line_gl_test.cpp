// The program: good input, bad input, interruption, a full disk.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "render/gl/context.h"
#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

/// Small enough to run in a second or two.
const Words kQuick = with(kSphere, {kPicture, {"--set", "acquisition.frames_per_volume=9"}});
const Words kResults = {
    "depth.exr", "error_depth.exr", "report.json", "surface.png", "truth_depth.exr", "volume.png"};

struct BadInput {
  std::string name;
  Words arguments;
  std::string expected;  ///< what the one line says after "wobblebench: "
};

void PrintTo(const BadInput& bad, std::ostream* out) {
  *out << bad.name;
}

class RefusesBadInput : public testing::TestWithParam<BadInput> {};

TEST_P(RefusesBadInput, WithOneLineAndExitCode2) {
  const ScratchFolder folder;
  folder.write("typo.toml", "[acquisition]\ndeptn_mm = 100\n");
  folder.write("type.toml", "[acquisition]\nsticks_per_frame = \"many\"\n");
  folder.write("range.toml", "[acquisition]\ndepth_mm = 4000\n");
  folder.write("syntax.toml", "[acquisition\n");
  folder.write("garbage.vdb", "this is not a VDB file, and is longer than a header would be");
  folder.write("empty.vdb", "");
  folder.write("lines.toml", "[phantom]\nname = \"a\\nb\"\n");
  const ProcessResult result = bench(GetParam().arguments, folder);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_EQ(result.err.find("wobblebench: " + GetParam().expected), 0u) << result.err;
  EXPECT_FALSE(fs::exists(folder.path() / "out")) << "left something behind";
}

INSTANTIATE_TEST_SUITE_P(
    CommandLine,
    RefusesBadInput,
    testing::Values(
        BadInput{"unknown_key",
                 {"run", "typo.toml"},
                 "typo.toml: acquisition.deptn_mm: unknown key; keys of"},
        BadInput{"wrong_type",
                 {"run", "type.toml"},
                 "type.toml: acquisition.sticks_per_frame = 'many': must be a whole number"},
        BadInput{"out_of_range",
                 {"run", "range.toml"},
                 "range.toml: acquisition.depth_mm = 4000: must be within 1 and 400"},
        BadInput{"syntax", {"run", "syntax.toml"}, "syntax.toml: line 1: "},
        BadInput{"missing_scene", {"run", "none.toml"}, "none.toml: no such file"},
        BadInput{"missing_vdb",
                 {"run", "--set", "phantom.name=file", "--set", "phantom.file=none.vdb"},
                 "--set: phantom.file = \"none.vdb\": no such file"},
        BadInput{"vdb_not_named",
                 {"run", "--set", "phantom.name=file"},
                 "--set: phantom.file = \"\": must be the path of a .vdb"},
        BadInput{"garbage_vdb",
                 {"run", "--set", "phantom.name=file", "--set", "phantom.file=garbage.vdb"},
                 "phantom.file = \"garbage.vdb\": "},
        BadInput{"empty_vdb",
                 {"run", "--set", "phantom.name=file", "--set", "phantom.file=empty.vdb"},
                 "--set: phantom.file = \"empty.vdb\": "},
        BadInput{"out_is_a_file", {"run", "--out", "typo.toml"}, "--out = typo.toml: "},
        BadInput{"out_under_a_file", {"run", "--out", "typo.toml/out"}, "--out = typo.toml/out: "},
        BadInput{"out_cannot_be_written", {"run", "--out", "/proc/out"}, "--out = /proc/out: "},
        BadInput{"board_nonsense",
                 {"run", "--board", "nonsense"},
                 "--board = nonsense: must be sim, file="},
        BadInput{"unknown_phantom",
                 {"phantom", "--set", "phantom.name=cat"},
                 "--set: phantom.name = \"cat\": must be one of"},
        BadInput{"voxel_too_coarse",
                 {"run",
                  "--set",
                  "phantom.name=sphere",
                  "--set",
                  "phantom.radius_mm=5",
                  "--set",
                  "phantom.voxel_mm=4"},
                 "--set: phantom.voxel_mm = 4: must be at most 2.5 for the phantom sphere"},
        BadInput{"line_break_in_a_value",
                 {"run", "--set", "phantom.name=a\nb"},
                 "--set phantom.name=a\\nb: must be"},
        BadInput{"line_break_in_a_file",
                 {"run", "lines.toml"},
                 "lines.toml: phantom.name = \"a\\nb\": must be one of"},
        BadInput{
            "line_break_in_out", {"run", "--out", "typo.toml/a\nb"}, "--out = typo.toml/a\\nb"},
        BadInput{"no_utf8",
                 {"run", "--set", "phantom.file=\xff.vdb"},
                 "--set phantom.file=\\xff.vdb: must be UTF-8"},
        BadInput{"name_too_long", {"run", std::string(300, 'a')}, std::string(300, 'a') + ": File"},
        BadInput{"scene_is_a_folder", {"run", "."}, ".: not a file"},
        BadInput{"scene_is_empty", {"run", ""}, "SCENE: is empty"},
        BadInput{
            "beyond_the_memory",
            {"run",
             "--set",
             "acquisition.sticks_per_frame=1024",
             "--set",
             "acquisition.frames_per_volume=1024",
             "--set",
             "acquisition.samples_per_stick=4096",
             "--set",
             "probe.center_frequency_mhz=20",
             "--set",
             "probe.fractional_bandwidth=1.5",
             "--set",
             "acquisition.depth_mm=400"},
            "--set: acquisition.frames_per_volume = 1024, acquisition.sticks_per_frame = 1024, "
            "acquisition.samples_per_stick = 4096: need about "},
        BadInput{"age_out_of_range",
                 {"phantom", "--set", "phantom.gestational_age_weeks=12"},
                 "--set: phantom.gestational_age_weeks = 12: must be within 20 and 30"},
        BadInput{"even_kernel",
                 {"run", "--set", "render.ray_casting.kernel_3d=2"},
                 "--set: render.ray_casting.kernel_3d = 2: "},
        BadInput{"set_without_value",
                 {"run", "--set", "acquisition.depth_mm"},
                 "--set acquisition.depth_mm: must be SECTION.KEY=VALUE"},
        BadInput{"unknown_option", {"run", "--colour"}, ""},
        BadInput{"unknown_command", {"paint"}, ""},
        BadInput{"no_command", {}, ""},
        BadInput{"repeats_of_none",
                 {"tables", "--repeats", "0"},
                 "--repeats = 0: must be a whole number from 1 to 100"},
        BadInput{"unknown_gl", {"run", "--gl", "glide"}, "--gl: glide not in {auto,"},
        BadInput{"unknown_gl_of_tables", {"tables", "--gl", "glide"}, "--gl: glide not in {auto,"},
        BadInput{"pipeline_of_tables",
                 {"tables", "--set", "render.pipeline.mode=plain"},
                 "render.pipeline.mode: is set by the tables themselves"},
        BadInput{"view_of_modes",
                 {"modes", "--set", "render.view.yaw_deg=5"},
                 "render.view.yaw_deg: is set by the comparison itself"},
        BadInput{"modes_without_surface",
                 {"modes", "--set", "render.ray_casting.mode=volume"},
                 "render.ray_casting.mode = \"volume\": must be surface or both"}),
    [](const auto& test) { return test.param.name; });

TEST(CommandLine, HelpIsNoError) {
  const ScratchFolder folder;
  const auto result = bench({"--help"}, folder);
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.out.find("tables"), std::string::npos);
}

TEST(CommandLine, RunWritesItsResultsAndAReportWithTheDocumentedKeys) {
  const ScratchFolder folder;
  const auto result = bench(with({"run", "--json"}, {kQuick}), folder);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(folder.files("out"), kResults);
  const auto report = nlohmann::json::parse(result.out);
  EXPECT_NEAR(report.at("acquisition").at("volume_time_ms").get<double>(),
              9 * 64 * 2 * 0.16 / 1540 * 1e3,
              1e-5);
  ASSERT_EQ(report.at("render").at("passes").size(), 4u);
  for (const auto& pass : report.at("render").at("passes"))
    EXPECT_GT(pass.at("ms").get<double>(), 0) << pass;
  for (const char* figure : {"bias", "rms", "p95"}) {
    EXPECT_TRUE(report.at("error").at("depth_mm").at(figure).is_number()) << figure;
  }
  EXPECT_TRUE(report.at("error").at("missed_percent").is_number());
  EXPECT_TRUE(report.at("error").at("false_percent").is_number());
  const auto& board = report.at("board");
  EXPECT_EQ(board.at("emitted"), 9 * 64);
  auto accounted = board.at("delivered").get<int>();
  for (const auto& [cause, count] : board.at("lost").items()) accounted += count.get<int>();
  EXPECT_EQ(board.at("emitted"), accounted);
  EXPECT_FALSE(report.at("effects").empty());
  EXPECT_EQ(report.at("provenance").at("board"), "simulated");
  EXPECT_FALSE(report.at("provenance").at("gl_renderer").get<std::string>().empty());
}

TEST(CommandLine, RunRegistersWhereItIsAskedTo) {
  const ScratchFolder folder;
  const auto report_of = [&](const Words& more) {
    return nlohmann::json::parse(bench(with({"run", "--json"}, {kQuick, more}), folder).out);
  };
  const auto plain = report_of({}), registered = report_of({"--register"});
  EXPECT_TRUE(plain.at("fit").at("registration").is_null());
  EXPECT_EQ(plain.at("fit").at("why_not"), "not asked for; --register fits it");
  EXPECT_FALSE(plain.at("wall_ms").contains("register"));
  EXPECT_GT(registered.at("fit").at("registration").at("points").get<int>(), 20);
  EXPECT_TRUE(registered.at("wall_ms").contains("register"));
}

TEST(CommandLine, ARunFromTheCacheIsTheSameRun) {
  const ScratchFolder folder;
  const auto run = [&](const std::string& out, const Words& more, const fs::path& cache) {
    const auto result =
        bench(with({"run", "--json", "--out", out}, {kQuick, more}), folder, {.cache_home = cache});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(result.out);
  };
  const fs::path cache = folder.path() / "cache";
  const nlohmann::json made = {{"phantom", false}, {"tissue_map", false}};
  const nlohmann::json kept = {{"phantom", true}, {"tissue_map", true}};
  EXPECT_EQ(run("without", {"--no-cache"}, cache).at("cached"), made);
  EXPECT_FALSE(fs::exists(cache / "wobblebench")) << "the folder itself is the GL's too";
  EXPECT_EQ(run("cold", {}, cache).at("cached"), made);
  EXPECT_EQ(run("warm", {}, cache).at("cached"), kept);
  EXPECT_EQ(run("anew", {"--no-cache"}, cache).at("cached"), made);
  EXPECT_EQ(run("unwritable", {}, "/dev/null").at("cached"), made);
  for (const auto& name : kResults) {
    if (name == "report.json") continue;
    for (const char* out : {"cold", "warm", "anew", "unwritable"}) {
      EXPECT_EQ(bytes_of(folder.path() / out / name), bytes_of(folder.path() / "without" / name))
          << out << " " << name;
    }
  }
}

TEST(CommandLine, ARecordingFromTheCacheIsTheSameRecording) {
  const ScratchFolder folder;
  const Words scene = {"--set", "phantom.name=sphere", "--set", "phantom.voxel_mm=2"};
  const fs::path cache = folder.path() / "cache";
  for (const auto& [out, more] : std::map<std::string, Words>{
           {"1 without", {"--no-cache"}}, {"2 cold", {}}, {"3 warm", {}}}) {
    const auto result =
        bench(with({"record", "--out", out}, {scene, more}), folder, {.cache_home = cache});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(bytes_of(folder.path() / out / "recording.wbst"),
              bytes_of(folder.path() / "1 without" / "recording.wbst"))
        << out;
  }
  EXPECT_EQ(folder.files("cache/wobblebench").size(), 2U) << "a phantom and its map";
}

TEST(CommandLine, PhantomIsReadBackAndScannedTheSame) {
  const ScratchFolder folder;
  const Words small = {"--set", "phantom.name=sphere", "--set", "phantom.voxel_mm=2"};
  const auto made = bench(with({"phantom"}, {small}), folder);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(folder.files("out"), (Words{"phantom.vdb", "report.json"}));
  const auto direct = bench(with({"run", "--json", "--out", "a"}, {kQuick}), folder);
  auto from_file = kQuick;
  from_file[1] = "phantom.name=file";
  const auto read = bench(
      with({"run", "--json", "--out", "b", "--set", "phantom.file=out/phantom.vdb"}, {from_file}),
      folder);
  ASSERT_EQ(read.exit_code, 0) << read.err;
  EXPECT_EQ(nlohmann::json::parse(direct.out).at("error"),
            nlohmann::json::parse(read.out).at("error"));
}

TEST(CommandLine, InterruptionLeavesAllResultsOrNone) {
  const ScratchFolder folder;
  int interrupted = 0;
  for (int ms = 5; ms < 4000; ms += ms / 2 + 5) {
    const std::string out = "out" + std::to_string(ms);
    const auto result = bench(with({"run", "--out", out}, {kQuick}),
                              folder,
                              {.interrupt_after = std::chrono::milliseconds(ms),
                               .signal = ms % 2 == 0 ? SIGINT : SIGTERM});
    const auto files = folder.files(out);
    EXPECT_TRUE(files.empty() || files == kResults)
        << "after " << ms << " ms: " << testing::PrintToString(files);
    interrupted += result.exit_code > 128;
  }
  EXPECT_GT(interrupted, 2);
}

TEST(CommandLine, AnInterruptedPhantomLeavesNothingWhileItIsWritten) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const ScratchFolder folder;
    const auto being_written = [&] {
      return fs::exists(folder.path() / "out/.wobblebench-partial/phantom.vdb");
    };
    const auto result = bench({"phantom",
                               "--set",
                               "phantom.name=sphere",
                               "--set",
                               "phantom.radius_mm=60",
                               "--set",
                               "phantom.voxel_mm=0.5"},
                              folder,
                              {.interrupt_when = being_written, .signal = signal});
    EXPECT_EQ(result.exit_code, 128 + signal) << result.err;
    EXPECT_FALSE(fs::exists(folder.path() / "out"));
  }
}

TEST(CommandLine, AMissingGlFailsBeforeAnyWork) {
  const auto built = render::context_backends();
  if (std::find(built.begin(), built.end(), "egl") == built.end()) GTEST_SKIP() << "no EGL";
  setenv("__EGL_VENDOR_LIBRARY_DIRS", "/nonexistent", 1);
  for (const char* command : {"run", "tables", "modes"}) {
    const ScratchFolder folder;
    const auto result = bench({command, "--gl", "egl"}, folder);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(result.err.find("wobblebench: egl: "), 0u) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(folder.path() / "out"));
  }
  unsetenv("__EGL_VENDOR_LIBRARY_DIRS");
}

TEST(CommandLine, ModesFindsTheSamePictureFromEachDirection) {
  const ScratchFolder folder;
  const auto result = bench(with({"modes", "--json"}, {kQuick}), folder);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(folder.files("out"), (Words{"modes.md", "report.json"}));
  const auto report = nlohmann::json::parse(result.out);
  ASSERT_EQ(report.at("modes").size(), 5u);
  for (const auto& row : report.at("modes")) {
    EXPECT_EQ(row.at("phantom"), "sphere");
    EXPECT_GT(row.at("both_hit").get<int>(), 0) << row;
    EXPECT_TRUE(row.at("same").get<bool>()) << row;
  }
}

TEST(CommandLine, RunReportsTheGlThatRendered) {
  std::string first;
  for (const std::string& gl : render::context_backends()) {
    const ScratchFolder folder;
    const auto result = bench(with({"run", "--json", "--gl", gl}, {kQuick}), folder);
    if (result.exit_code == 1) continue;  // not on this machine
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(nlohmann::json::parse(result.out).at("provenance").at("gl_backend"), gl);
    if (first.empty()) first = gl;
  }
  const ScratchFolder folder;
  const auto result = bench(with({"run", "--json"}, {kQuick}), folder);  // --gl auto
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out).at("provenance").at("gl_backend"), first);
}

/// Runs `command` on a disk that is full one byte, and a hundred, before the end of each of its
/// files. Nothing may be left, unless this run's report is short enough to fit.
void expect_no_half_file(const Words& command, const Words& results) {
  const ScratchFolder folder;
  ASSERT_EQ(bench(with(command, {Words{"--out", "whole"}}), folder).exit_code, 0);
  ASSERT_EQ(folder.files("whole"), results);
  std::set<long> limits = {0};
  std::map<std::string, std::uintmax_t> sizes;
  for (const auto& name : results) {
    sizes[name] = fs::file_size(folder.path() / "whole" / name);
    for (const long missing : {1L, 100L}) limits.insert(static_cast<long>(sizes[name]) - missing);
  }
  int failed = 0;
  for (const long bytes : limits) {
    SCOPED_TRACE(std::to_string(bytes) + " bytes");
    const std::string out = "out" + std::to_string(bytes);
    const auto result = bench(with(command, {Words{"--out", out}}), folder, {.file_bytes = bytes});
    failed += result.exit_code != 0;
    EXPECT_EQ(folder.files(out), result.exit_code == 0 ? results : Words{}) << result.err;
    for (const auto& name : folder.files(out)) {
      if (name == "report.json") continue;
      EXPECT_EQ(fs::file_size(folder.path() / out / name), sizes[name]) << name;
    }
  }
  EXPECT_GE(failed, static_cast<int>(limits.size()) - 2) << "all but those about the report";
}

TEST(CommandLine, AFullDiskLeavesNoHalfRun) {
  expect_no_half_file(with({"run"}, {kQuick}), kResults);
}

TEST(CommandLine, AFullDiskLeavesNoHalfPhantom) {
  expect_no_half_file({"phantom", "--set", "phantom.name=sphere", "--set", "phantom.voxel_mm=2"},
                      {"phantom.vdb", "report.json"});
}

TEST(CommandLine, ResultsOfAnEarlierRunSurviveAFailedOne) {
  const ScratchFolder folder;
  ASSERT_EQ(bench(with({"run"}, {kQuick}), folder).exit_code, 0);
  const auto failed = bench(with({"run"}, {kQuick}), folder, {.file_bytes = 500});
  EXPECT_EQ(failed.exit_code, 1);
  EXPECT_EQ(folder.files("out"), kResults);
}

}  // namespace
}  // namespace wobblebench::bench
