// 2 000 random command lines that are wrong: each is refused with one line, at once, and leaves
// nothing.
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
#include "tests/support/process.h"

namespace wobblebench::bench {
namespace {

using testing_support::ProcessResult;
using testing_support::run_process;
using testing_support::ScratchFolder;
namespace fs = std::filesystem;

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

/// Runs the program in a fork of this process, which saves loading its libraries 2 000 times.
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
        Case{"wobblebench", wobblebench_program, WOBBLEBENCH_PROGRAM, true, 1700, 50},
        Case{"wobblebench_tables", tables_program, WOBBLEBENCH_TABLES_PROGRAM, false, 300, 20}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace wobblebench::bench
