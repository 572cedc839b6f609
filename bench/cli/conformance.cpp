// The board's contract, checked on any board; and the proof that each check can fail.
#include <memory>

#include "bench/board_checks/conformance/board_fixture.h"
#include "bench/board_checks/conformance/findings.h"
#include "bench/cli/conformance_report.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  SceneArguments scene;
  OutputArguments output;
  std::vector<std::string> boards = {"sim"};
  bool each_fault = false;
  bool broken = false;
};

// Names of the steps.
constexpr const char* kBroken = "broken boards";
std::string opening(const BoardArguments& board) {
  return "open " + board.text;
}
std::string faulty_name(const BoardArguments& board, const std::string& faults) {
  return board.text + " with " + faults;
}

std::vector<PlannedStep> planned_steps(const std::vector<BoardArguments>& boards,
                                       const Arguments& arguments) {
  std::vector<PlannedStep> steps;
  for (const BoardArguments& board : boards) {
    steps.push_back({opening(board), is_simulated(board) ? 10.0 : 0.1});
    steps.push_back({board.text, 1});
    if (!arguments.each_fault) continue;
    for (const std::string& faults : each_fault()) steps.push_back({faulty_name(board, faults), 1});
  }
  if (arguments.broken) steps.push_back({kBroken, 15});
  return steps;
}

/// The suite on the board as it is and, where asked for, with each kind of fault.
std::vector<SuiteRun> check_board(const BoardArguments& board,
                                  const Scene& scene,
                                  bool with_each_fault,
                                  Progress& progress) {
  const ConformanceFixture fixture =
      progress.step(opening(board), [&] { return fixture_of(board, scene); });
  std::vector<SuiteRun> runs;
  runs.push_back({board.text, "", progress.step(board.text, [&](const PartDone& done) {
                    return run_conformance(fixture, done);
                  })});
  if (!with_each_fault) return runs;
  for (const std::string& faults : each_fault()) {
    const ConformanceFixture faulty = with_faults(fixture, faults);
    runs.push_back(
        {board.text, faults, progress.step(faulty_name(board, faults), [&](const PartDone& done) {
           return run_conformance(faulty, done);
         })});
  }
  return runs;
}

std::vector<BoardArguments> boards_of(const Arguments& arguments) {
  std::vector<BoardArguments> boards;
  for (const std::string& text : arguments.boards) {
    boards.push_back(parse_board(text));
    // What cannot be opened is refused before the folder is made; what is made for the checks takes
    // long, and comes after it.
    const bool made = is_simulated(boards.back()) || boards.back().link.value.ends_with("stand-in");
    if (!made) open_outside_link(boards.back());
  }
  return boards;
}

int check_boards(const Arguments& arguments) {
  const Scene scene = load_scene(arguments.scene.file, arguments.scene.settings);
  const std::vector<BoardArguments> boards = boards_of(arguments);
  const auto work = [&](OutputFolder& out, Progress& progress) {
    ConformanceFindings findings;
    for (const BoardArguments& board : boards) {
      const auto runs = check_board(board, scene, arguments.each_fault, progress);
      findings.runs.insert(findings.runs.end(), runs.begin(), runs.end());
    }
    if (arguments.broken) {
      findings.defects =
          progress.step(kBroken, [](const PartDone& done) { return check_defects(done); });
    }
    out.write_text("conformance.md", conformance_markdown(findings, provenance_of_this_machine()));
    return CommandResult{conformance_report(findings, scene, progress.steps()),
                         conformance_summary(findings),
                         findings.passed() ? kDone : kFailed};
  };
  return run_in_folder(arguments.output, planned_steps(boards, arguments), work);
}

}  // namespace

Command add_conformance_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = add_subcommand(app, "conformance", "Check the board's contract on any board");
  add_scene_options(command, arguments->scene);
  add_output_options(command, arguments->output);
  add_list(command,
           "--board",
           arguments->boards,
           "As for run, or xdma=stand-in, xdma=fifo-stand-in (repeatable)");
  add_flag(
      command, "--each-fault", arguments->each_fault, "On the board with each kind of fault, too");
  add_flag(
      command, "--broken", arguments->broken, "Show with broken boards that each check can fail");
  return {&command, [arguments] { return check_boards(*arguments); }};
}

}  // namespace wobblebench::bench
