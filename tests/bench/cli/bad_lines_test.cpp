// Command lines that are wrong, some with the text of their refusal and 650 random ones: each is
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

/// Runs the program in a fork of this process, which saves loading its libraries 650 times.
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
    EXPECT_TRUE(holds(result.err, line.says)) << line.says;
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
        Case{"wobblebench", wobblebench_program, WOBBLEBENCH_PROGRAM, true, 500, 50},
        Case{"wobblebench_tables", tables_program, WOBBLEBENCH_TABLES_PROGRAM, false, 150, 20}),
    [](const auto& test) { return std::string(test.param.name); });

/// Lines that are wrong in a way that has a text of its own.
const std::vector<RefusedLine> kBadInput = {
    {"run typo.toml", "typo.toml: acquisition.deptn_mm: unknown key; keys of"},
    {"run type.toml", "type.toml: acquisition.sticks_per_frame = 'many': must be a whole number"},
    {"run range.toml", "range.toml: acquisition.depth_mm = 4000: must be within 1 and 400"},
    {"run syntax.toml", "syntax.toml: line 1: "},
    {"run none.toml", "none.toml: no such file"},
    {"run --set phantom.name=file --set phantom.file=none.vdb",
     "--set: phantom.file = \"none.vdb\": no such file"},
    {"run --set phantom.name=file", "--set: phantom.file = \"\": must be the path of a .vdb"},
    {"run --set phantom.name=file --set phantom.file=garbage.vdb",
     "phantom.file = \"garbage.vdb\": "},
    {"run --set phantom.name=file --set phantom.file=empty.vdb",
     "--set: phantom.file = \"empty.vdb\": "},
    {"run --out typo.toml", "--out = typo.toml: "},
    {"run --out typo.toml/out", "--out = typo.toml/out: "},
    {"run --out /proc/out", "--out = /proc/out: "},
    {"run --board nonsense", "--board = nonsense: must be sim, file="},
    {"phantom --set phantom.name=cat", "--set: phantom.name = \"cat\": must be one of"},
    {"run --set phantom.name=sphere --set phantom.radius_mm=5 --set phantom.voxel_mm=4",
     "--set: phantom.voxel_mm = 4: must be at most 2.5 for the phantom sphere"},
    {Words{"run", "--set", "phantom.name=a\nb"}, "--set phantom.name=a\\nb: must be"},
    {"run lines.toml", "lines.toml: phantom.name = \"a\\nb\": must be one of"},
    {Words{"run", "--out", "typo.toml/a\nb"}, "--out = typo.toml/a\\nb"},
    {Words{"run", "--set", "phantom.file=\xff.vdb"}, "--set phantom.file=\\xff.vdb: must be UTF-8"},
    {Words{"run", std::string(300, 'a')}, std::string(300, 'a') + ": File"},
    {"run .", ".: not a file"},
    {Words{"run", ""}, "SCENE: is empty"},
    {"run --set acquisition.sticks_per_frame=1024 --set "
     "acquisition.frames_per_volume=1024 --set acquisition.samples_per_stick=4096 "
     "--set probe.center_frequency_mhz=20 --set probe.fractional_bandwidth=1.5 "
     "--set acquisition.depth_mm=400",
     "--set: acquisition.frames_per_volume = 1024, acquisition.sticks_per_frame = 1024, "
     "acquisition.samples_per_stick = 4096: need about "},
    {"phantom --set phantom.gestational_age_weeks=12",
     "--set: phantom.gestational_age_weeks = 12: must be within 20 and 34"},
    {"run --set render.ray_casting.kernel_3d=2", "--set: render.ray_casting.kernel_3d = 2: "},
    {"run --set acquisition.depth_mm", "--set acquisition.depth_mm: must be SECTION.KEY=VALUE"},
    {"conformance none.toml", "none.toml: "},
    {"conformance --board nonsense", "--board = nonsense: "},
    {"conformance --board file=none.wbst", "--board = file=none.wbst: "},
    {"conformance --board xdma=none", "--board = xdma=none: "},
    {"tables --board file=none.wbst", "--board = file=none.wbst: "},
    {"record --board file=none.wbst", "--board = file=none.wbst: "},
    {"record --board xdma=none", "--board = xdma=none: "},
    {"run --board file=none.wbst", "--board = file=none.wbst: "},
    {"rungs --set phantom.name=mesh --set phantom.file=bad.stl --set phantom.unit_mm=1",
     "phantom.file = \"bad.stl\": "},
    {"rungs --set simulation.speckle=false",
     "simulation.speckle = false: needs the rung geometry or field; the rung is "
     "reference (asked for)\n"},
    {"run --colour", "--colour: no such option"},
    {"paint", "paint: no such command"},
    {"", "A subcommand is required"},
    {"tables --repeats 0", "--repeats = 0: must be a whole number from 1 to 100"},
    {"board --repeats 101", "--repeats = 101: must be a whole number from 1 to 100"},
    {"board range.toml", "The following argument was not"},
    {"run --gl glide", "--gl: glide not in {auto,"},
    {"tables --gl glide", "--gl: glide not in {auto,"},
    {"tables --set render.pipeline.mode=plain",
     "render.pipeline.mode: is set by the tables themselves"},
};

using BadInput = InFolder;

TEST_F(BadInput, IsRefusedWithOneLineAndLeavesNothing) {
  folder_.write("typo.toml", "[acquisition]\ndeptn_mm = 100\n");
  folder_.write("type.toml", "[acquisition]\nsticks_per_frame = \"many\"\n");
  folder_.write("range.toml", "[acquisition]\ndepth_mm = 4000\n");
  folder_.write("syntax.toml", "[acquisition\n");
  folder_.write("garbage.vdb", "this is not a VDB file, and is longer than a header would be");
  folder_.write("empty.vdb", "");
  folder_.write("bad.stl", "solid x\nendsolid x\n");
  folder_.write("lines.toml", "[phantom]\nname = \"a\\nb\"\n");
  expect_refusals(kBadInput);
}

}  // namespace
}  // namespace wobblebench::bench
