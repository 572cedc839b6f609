// Command lines that are wrong, some with the text of their refusal and 1 300 random ones: each is
// refused with one line, at once, and leaves nothing.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <set>

#include "bench/command/commands.h"
#include "bench/studies/tables/tables_program.h"
#include "tests/bench/cli/bad_lines.h"
#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

/// A line that was taken for a good one works for minutes; it is ended by a signal after these.
constexpr unsigned kPatience_s = 30;

std::string read_from_start(int descriptor) {
  std::string text;
  char piece[4096];
  ::lseek(descriptor, 0, SEEK_SET);
  for (ssize_t count = 0; (count = ::read(descriptor, piece, sizeof piece)) > 0;) {
    text.append(piece, static_cast<std::size_t>(count));
  }
  return text;
}

/// Runs the program in a fork of this process, which saves loading its libraries 1 300 times.
ProcessResult run_forked(const Program& program,
                         const std::vector<std::string>& words,
                         const fs::path& folder) {
  const int out = ::open(folder.c_str(), O_TMPFILE | O_RDWR, 0600);
  const int err = ::open(folder.c_str(), O_TMPFILE | O_RDWR, 0600);
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(kPatience_s);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(err, STDERR_FILENO);
    std::vector<char*> argv = {const_cast<char*>(program.name.c_str())};
    for (const auto& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    const bool there = ::chdir(folder.c_str()) == 0;
    const int code =
        there ? run_program(program, static_cast<int>(argv.size()) - 1, argv.data()) : 99;
    std::fflush(nullptr);
    ::_exit(code);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ProcessResult result{WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status),
                       read_from_start(out),
                       read_from_start(err)};
  ::close(out);
  ::close(err);
  return result;
}

/// Every file and folder below, by name.
std::set<std::string> content_of(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    names.insert(entry.path().lexically_relative(folder).string());
  }
  return names;
}

/// As a shell takes it.
std::string quoted(const Program& program, const std::vector<std::string>& words) {
  std::string line = program.name;
  for (const std::string& word : words) {
    line += " $'";
    for (const char c : word) {
      const auto byte = static_cast<unsigned char>(c);
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\x%02x", byte);
      line += byte < 0x20 || byte > 0x7e || c == '\'' || c == '\\' ? escaped : std::string(1, c);
    }
    line += "'";
  }
  return line;
}

/// Whether it was refused as a wrong line must be, and if not, why.
std::string fault_in(const Program& program, const ProcessResult& result) {
  if (result.exit_code != 1 && result.exit_code != 2) {
    return "exit code " + std::to_string(result.exit_code);
  }
  if (!result.out.empty()) return "stdout: " + result.out;
  const auto lines = std::count(result.err.begin(), result.err.end(), '\n');
  const bool one_line = lines == 1 && result.err.back() == '\n';
  if (!one_line || !result.err.starts_with(program.name + ": ")) return "stderr: " + result.err;
  return "";
}

struct Case {
  const char* name;
  Program (*program)();
  const char* path;  ///< of the built program
  bool takes_sim;
  int lines;
  int every_nth_built;  ///< of the lines through the built program, too
};

void PrintTo(const Case& one, std::ostream* out) {
  *out << one.name;
}

class RandomBadLines : public ::testing::TestWithParam<Case> {};

TEST_P(RandomBadLines, AreRefusedWithOneLineAndLeaveNothing) {
  const Case& one = GetParam();
  const Program program = one.program();
  const ScratchFolder folder;
  testing::make_named_files(folder.path());
  const auto before = content_of(folder.path());
  testing::BadLines lines(program, one.takes_sim, 15);
  std::set<std::string> ways;
  for (int i = 0; i < one.lines; ++i) {
    const testing::BadLine line = lines.next();
    ways.insert(line.why);
    SCOPED_TRACE(line.why + "; in a folder of make_named_files(): " + quoted(program, line.words));
    const bool built = i % one.every_nth_built == 0;
    const ProcessResult result = built ? run_process(one.path, line.words, folder.path())
                                       : run_forked(program, line.words, folder.path());
    EXPECT_EQ(fault_in(program, result), "");
    EXPECT_NE(result.err.find(line.says), std::string::npos) << line.says << ": " << result.err;
    const auto after = content_of(folder.path());
    EXPECT_EQ(after, before);
    for (const std::string& name : after) {
      if (!before.contains(name)) fs::remove_all(folder.path() / name);
    }
  }
  EXPECT_GT(ways.size(), one.takes_sim ? 40U : 15U);
}

INSTANTIATE_TEST_SUITE_P(
    CommandLine,
    RandomBadLines,
    ::testing::Values(
        Case{"wobblebench", wobblebench_program, WOBBLEBENCH_PROGRAM, true, 1000, 50},
        Case{"wobblebench_tables", tables_program, WOBBLEBENCH_TABLES_PROGRAM, false, 300, 20}),
    [](const auto& test) { return std::string(test.param.name); });

/// A line that is wrong in a way that has a text of its own.
struct BadInput {
  std::string name;
  Words arguments;
  std::string expected;  ///< what the one line says after "wobblebench: "
};

void PrintTo(const BadInput& bad, std::ostream* out) {
  *out << bad.name;
}

class RefusesBadInput : public ::testing::TestWithParam<BadInput> {};

TEST_P(RefusesBadInput, WithOneLineAndExitCode2) {
  const ScratchFolder folder;
  folder.write("typo.toml", "[acquisition]\ndeptn_mm = 100\n");
  folder.write("type.toml", "[acquisition]\nsticks_per_frame = \"many\"\n");
  folder.write("range.toml", "[acquisition]\ndepth_mm = 4000\n");
  folder.write("syntax.toml", "[acquisition\n");
  folder.write("garbage.vdb", "this is not a VDB file, and is longer than a header would be");
  folder.write("empty.vdb", "");
  folder.write("bad.stl", "solid x\nendsolid x\n");
  folder.write("lines.toml", "[phantom]\nname = \"a\\nb\"\n");
  const ProcessResult result = bench(GetParam().arguments, folder);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(fault_in(wobblebench_program(), result), "");
  EXPECT_EQ(result.err.find("wobblebench: " + GetParam().expected), 0u) << result.err;
  EXPECT_FALSE(fs::exists(folder.path() / "out")) << "left something behind";
}

INSTANTIATE_TEST_SUITE_P(
    CommandLine,
    RefusesBadInput,
    ::testing::Values(
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
                 "--set: phantom.gestational_age_weeks = 12: must be within 20 and 34"},
        BadInput{"even_kernel",
                 {"run", "--set", "render.ray_casting.kernel_3d=2"},
                 "--set: render.ray_casting.kernel_3d = 2: "},
        BadInput{"set_without_value",
                 {"run", "--set", "acquisition.depth_mm"},
                 "--set acquisition.depth_mm: must be SECTION.KEY=VALUE"},
        BadInput{"conformance_of_no_scene", {"conformance", "none.toml"}, "none.toml: "},
        BadInput{"conformance_of_nonsense",
                 {"conformance", "--board", "nonsense"},
                 "--board = nonsense: "},
        BadInput{"conformance_of_no_file",
                 {"conformance", "--board", "file=none.wbst"},
                 "--board = file=none.wbst: "},
        BadInput{"conformance_of_no_card",
                 {"conformance", "--board", "xdma=none"},
                 "--board = xdma=none: "},
        BadInput{"tables_of_no_file",
                 {"tables", "--board", "file=none.wbst"},
                 "--board = file=none.wbst: "},
        BadInput{"record_of_no_file",
                 {"record", "--board", "file=none.wbst"},
                 "--board = file=none.wbst: "},
        BadInput{"record_of_no_card", {"record", "--board", "xdma=none"}, "--board = xdma=none: "},
        BadInput{
            "run_of_no_file", {"run", "--board", "file=none.wbst"}, "--board = file=none.wbst: "},
        BadInput{"rungs_of_a_bad_mesh",
                 {"rungs",
                  "--set",
                  "phantom.name=mesh",
                  "--set",
                  "phantom.file=bad.stl",
                  "--set",
                  "phantom.unit_mm=1"},
                 "phantom.file = \"bad.stl\": "},
        BadInput{"rungs_that_cannot_show_it",
                 {"rungs", "--set", "simulation.speckle=false"},
                 "simulation.speckle = false: needs the rung geometry or field; the rung is "
                 "reference (asked for)\n"},
        BadInput{"unknown_option", {"run", "--colour"}, "--colour: no such option"},
        BadInput{"unknown_command", {"paint"}, "paint: no such command"},
        BadInput{"no_command", {}, "A subcommand is required"},
        BadInput{"repeats_of_none",
                 {"tables", "--repeats", "0"},
                 "--repeats = 0: must be a whole number from 1 to 100"},
        BadInput{"repeats_of_the_board",
                 {"board", "--repeats", "101"},
                 "--repeats = 101: must be a whole number from 1 to 100"},
        BadInput{"scene_of_the_board", {"board", "range.toml"}, "The following argument was not"},
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

}  // namespace
}  // namespace wobblebench::bench
