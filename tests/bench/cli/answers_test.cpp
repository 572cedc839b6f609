// What both programs answer on their standard streams, whatever they are asked.
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>

#include "base/text.h"
#include "bench/command/commands.h"
#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

const Words kSmallSphere = with({"phantom"}, {kSphere});

/// Through a shell: `line` with PROGRAM replaced.
ProcessResult shell(const std::string& program,
                    const std::string& line,
                    const ScratchFolder& folder) {
  const std::string command = std::regex_replace(line, std::regex("PROGRAM"), shell_word(program));
  return run_process("/bin/sh", {"-c", command}, folder.path());
}

int lines_in(const std::string& text) {
  return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

using Answers = InFolder;

TEST_F(Answers, StdoutThatCannotBeWrittenIsAnError) {
  for (const char* const to : {">/dev/full", ">&-", "</dev/null >&0"}) {
    for (const char* const command :
         {"--help",
          "--version",
          "rehearse --seeds 2",
          "rehearse --seeds 2 --json",
          "phantom --set phantom.name=sphere --set phantom.voxel_mm=2",
          "phantom --set phantom.name=sphere --set phantom.voxel_mm=2 --json"}) {
      const ScratchFolder folder;
      const auto result =
          shell(WOBBLEBENCH_PROGRAM, std::string("PROGRAM ") + command + " " + to, folder);
      EXPECT_EQ(result.exit_code, 1) << command << to;
      const auto said = result.err.find("wobblebench: stdout cannot be written: ");
      ASSERT_NE(said, std::string::npos) << command << to << ": " << result.err;
      EXPECT_EQ(lines_in(result.err.substr(said)), 1) << result.err;
    }
    const ScratchFolder folder;
    EXPECT_EQ(
        shell(WOBBLEBENCH_TABLES_PROGRAM, std::string("PROGRAM --help ") + to, folder).exit_code,
        1);
  }
}

TEST_F(Answers, VersionIsNameVersionAndCommit) {
  const std::regex line(R"((wobblebench|wobblebench-tables) \d+\.\d+\.\d+, commit [0-9a-z-]+\n)");
  for (const char* const program : {WOBBLEBENCH_PROGRAM, WOBBLEBENCH_TABLES_PROGRAM}) {
    const auto result = run_process(program, {"--version"}, folder_.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(std::regex_match(result.out, line)) << result.out;
    EXPECT_EQ(result.err, "");
  }
}

TEST_F(Answers, HelpOfEveryCommandIsNoError) {
  const auto all = bench("--help");
  EXPECT_EQ(all.exit_code, 0);
  CLI::App app;
  for (const Command& one : wobblebench_program().add_commands(app)) {
    const std::string command = one.parser->get_name();
    EXPECT_TRUE(holds(all.out, std::string("\n  ") + command + " ")) << command;
    for (const char* const help : {"-h", "--help"}) {
      const auto result = bench({command, help});
      EXPECT_EQ(result.exit_code, 0) << command;
      EXPECT_TRUE(holds(result.out, std::string("Usage: wobblebench ") + command));
      EXPECT_EQ(result.err, "");
    }
  }
  EXPECT_TRUE(folder_.files().empty());
}

TEST_F(Answers, PhantomPrintsASummaryAndJsonWhereAsked) {
  const auto summary = bench(kSmallSphere);
  ASSERT_EQ(summary.exit_code, 0) << summary.err;
  EXPECT_FALSE(nlohmann::json::accept(summary.out.substr(0, summary.out.rfind("out/"))))
      << summary.out;
  EXPECT_EQ(summary.out.find("phantom     sphere in amniotic_fluid\n"), 0U) << summary.out;
  EXPECT_TRUE(holds(summary.out, "voxels of 2 mm"));
  EXPECT_TRUE(holds(summary.out, "results     out/phantom.vdb\n"));
  const auto json = bench(with(kSmallSphere, {Words{"--json"}}));
  EXPECT_EQ(nlohmann::json::parse(json.out).at("phantom").at("name"), "sphere");
}

TEST_F(Answers, NumbersAreDecimal) {
  const auto report =
      report_of(bench("rehearse --seeds 010 --first-seed 08 --json")).at("rehearsal");
  EXPECT_EQ(report.at("seeds"), 10);
  EXPECT_EQ(report.at("first_seed"), 8);
}

TEST_F(Answers, ARefusalThatOnlyThePhantomFindsLeavesNoFolder) {
  folder_.write("bad.stl", "solid x\nendsolid x\n");
  const Words mesh = words_of(
      "--out new/deep --set phantom.name=mesh --set phantom.file=bad.stl --set phantom.unit_mm=1");
  for (const char* const command :
       {"phantom", "record", "run", "tables", "conformance", "rungs", "accuracy"}) {
    const auto result = bench(with({command}, {mesh}));
    EXPECT_EQ(result.exit_code, 2) << command;
    EXPECT_EQ(lines_in(result.err), 1) << result.err;
    EXPECT_EQ(folder_.files(), Words{"bad.stl"}) << command;
    fs::remove_all(at("new"));
  }
}

TEST_F(Answers, AnInterruptedRunLeavesNoNewFolder) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const ScratchFolder folder;
    const auto result =
        run_process(WOBBLEBENCH_PROGRAM,
                    words_of("run --out new/deep"),
                    folder.path(),
                    {.interrupt_when = [&] { return fs::exists(folder.path() / "new/deep"); },
                     .signal = signal});
    EXPECT_EQ(result.exit_code, 128 + signal) << result.err;
    EXPECT_TRUE(result.err.ends_with("wobblebench: interrupted\n")) << result.err;
    EXPECT_TRUE(folder.files().empty());
  }
}

TEST_F(Answers, ALongCommandSaysHowLongItWillStillTake) {
  const auto result = shell(WOBBLEBENCH_PROGRAM,
                            "PROGRAM rehearse --seeds 300000 2>err & "
                            "for i in $(seq 300); do grep -q left err && break; sleep 0.2; done; "
                            "kill -TERM $!; wait $!; code=$?; cat err >&2; exit $code",
                            folder_);
  EXPECT_EQ(result.exit_code, 128 + SIGTERM);
  const std::regex line(R"(rehearse: \d+ of 300000, \d+ s, about \d+ (s|min \d+ s) left\n)");
  EXPECT_TRUE(std::regex_search(result.err, line)) << result.err;
}

}  // namespace
}  // namespace wobblebench::bench
