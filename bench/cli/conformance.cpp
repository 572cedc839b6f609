// The board's contract, checked on any board.
#include <algorithm>
#include <iomanip>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "bench/board_checks/conformance/suite.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"
#include "bench/output/report.h"
#include "bench/output/report_parts.h"
#include "bench/pipeline/acquisitions.h"
#include "bench/pipeline/scene_warnings.h"
#include "bench/results/check.h"
#include "bench/scene/scene.h"

namespace wobblebench::bench {

namespace {

/// The suite on one board.
struct SuiteRun {
  std::string board;
  std::string faults;  ///< added around it; empty: none
  std::vector<CheckOutcome> outcomes;
};

Json checks_json(const std::vector<SuiteRun>& runs) {
  Json checks = Json::array();
  for (const SuiteRun& run : runs) {
    for (const CheckOutcome& outcome : run.outcomes) {
      Check check{.group = "conformance", .name = outcome.name};
      if (outcome.kind == CheckOutcome::Kind::failed) check.failure = outcome.detail;
      if (outcome.kind == CheckOutcome::Kind::skipped) check.skipped = outcome.detail;
      checks.push_back(to_json(std::vector{check}).front());
      checks.back().update({{"board", run.board},
                            {"faults", run.faults.empty() ? Json(nullptr) : Json(run.faults)},
                            {"rule", outcome.rule}});
    }
  }
  return checks;
}

/// What each check saw, which may differ between two equal runs.
Json details_json(const std::vector<SuiteRun>& runs) {
  Json details = Json::array();
  for (const SuiteRun& run : runs) {
    for (const CheckOutcome& outcome : run.outcomes) details.push_back(outcome.detail);
  }
  return details;
}

void write_run(std::ostream& text, const SuiteRun& run) {
  text << "board " << run.board << (run.faults.empty() ? "" : " with ") << run.faults << ": "
       << count(run.outcomes, CheckOutcome::Kind::passed) << " passed, "
       << count(run.outcomes, CheckOutcome::Kind::failed) << " failed, "
       << count(run.outcomes, CheckOutcome::Kind::skipped) << " skipped\n";
  for (const CheckOutcome& outcome : run.outcomes) {
    const bool failed = outcome.kind == CheckOutcome::Kind::failed;
    text << "  " << (failed ? "FAILED " : to_string(outcome.kind)) << "  " << std::left
         << std::setw(20) << outcome.name << "  " << outcome.detail << "\n";
  }
}

std::vector<const SuiteRun*> bare_runs(const std::vector<SuiteRun>& runs) {
  std::vector<const SuiteRun*> bare;
  for (const SuiteRun& run : runs) {
    if (run.faults.empty()) bare.push_back(&run);
  }
  return bare;
}

std::string outcome_text(const CheckOutcome& outcome) {
  switch (outcome.kind) {
    case CheckOutcome::Kind::passed:
      return "passed";
    case CheckOutcome::Kind::failed:
      return "FAILED: " + outcome.detail;
    case CheckOutcome::Kind::skipped:
      break;
  }
  return "skipped: " + outcome.detail;
}

/// A row for each check, a column for each board.
Table check_table(const std::vector<const SuiteRun*>& runs) {
  Table table{.name = "checks", .columns = {{"check"}, {"rule"}}};
  for (const SuiteRun* run : runs) table.columns.push_back({run->board});
  for (std::size_t row = 0; row < runs.front()->outcomes.size(); ++row) {
    const CheckOutcome& first = runs.front()->outcomes[row];
    std::vector<Cell> cells = {Cell::code(first.name), first.rule};
    for (const SuiteRun* run : runs) cells.emplace_back(outcome_text(run->outcomes[row]));
    table.add(std::move(cells));
  }
  return table;
}

/// A row for each fault, a column for each board: passed, failed and skipped checks.
Table fault_table(const std::vector<SuiteRun>& runs) {
  Table table{.name = "faults", .columns = {{"faults"}}};
  for (const SuiteRun* run : bare_runs(runs)) table.columns.push_back({run->board});
  for (const std::string& faults : each_fault()) {
    std::vector<Cell> cells = {Cell::code(faults)};
    for (const SuiteRun& run : runs) {
      if (run.faults != faults) continue;
      const auto number = [&](CheckOutcome::Kind kind) {
        return std::to_string(count(run.outcomes, kind));
      };
      cells.emplace_back(number(CheckOutcome::Kind::passed) + " / " +
                         number(CheckOutcome::Kind::failed) + " / " +
                         number(CheckOutcome::Kind::skipped));
    }
    table.add(std::move(cells));
  }
  return table;
}

/// The text of report.json.
std::string conformance_report(const std::vector<SuiteRun>& runs,
                               const Scene& scene,
                               const StepTimes& times) {
  Json report = report_head("conformance", provenance_of_this_machine(), scene);
  report["checks"] = checks_json(runs);
  report["timing"]["details"] = details_json(runs);
  report["wall_ms"] = wall_json(times);
  return report_text(report);
}

KeyFigures answer_of(const std::vector<SuiteRun>& runs) {
  std::size_t all = 0, failed = 0, skipped = 0;
  for (const SuiteRun& run : runs) {
    all += run.outcomes.size();
    failed += count(run.outcomes, CheckOutcome::Kind::failed);
    skipped += count(run.outcomes, CheckOutcome::Kind::skipped);
  }
  return {{{"Failed",
            std::to_string(failed) + " of " + std::to_string(all),
            "checks",
            std::to_string(skipped) + " were skipped, where a board cannot be tested so",
            failed > 0}}};
}

/// Checks against boards, then faults against boards.
Document conformance_document(const std::vector<SuiteRun>& runs, const Provenance& provenance) {
  Document document{.title = "Conformance", .name = "conformance"};
  document.add(answer_of(runs))
      .add(Text{"Written by `wobblebench conformance`. CPU: " + provenance.cpu + ", " +
                std::to_string(provenance.threads) + " threads. Commit: " + provenance.commit +
                ". Each check opens the board anew. No card was there: `stand-in` behaves like its "
                "driver (hw/emulator), `fifo-stand-in` is a FIFO."})
      .add(check_table(bare_runs(runs)));
  if (bare_runs(runs).size() < runs.size()) {
    document.add(Heading{"With each fault"})
        .add(Text{"Checks that passed, failed and were skipped; what each skip waits for stands in "
                  "the report."})
        .add(fault_table(runs));
  }
  return document;
}

/// A line a check, for a terminal.
std::string conformance_summary(const std::vector<SuiteRun>& runs) {
  std::ostringstream text;
  for (const SuiteRun& run : runs) write_run(text, run);
  return text.str();
}

/// Each check of each board, for --junit.
std::vector<Check> test_cases(const std::vector<SuiteRun>& runs) {
  std::vector<Check> cases;
  for (const SuiteRun& run : runs) {
    const std::string with = run.faults.empty() ? "" : " with " + run.faults;
    for (const CheckOutcome& outcome : run.outcomes) {
      Check& test = cases.emplace_back(Check{"conformance." + run.board + with, outcome.name});
      const bool passed = outcome.kind == CheckOutcome::Kind::passed;
      const bool failed = outcome.kind == CheckOutcome::Kind::failed;
      (passed ? test.output : failed ? test.failure : test.skipped) = outcome.detail;
    }
  }
  return cases;
}

struct ConformanceArguments {
  SceneArguments scene;
  OutputArguments output;
  std::vector<std::string> boards = {"sim"};
  bool each_fault = false;
};

// Names of the steps.
std::string opening(const BoardArguments& board) {
  return "open " + board.text;
}
std::string faulty_name(const BoardArguments& board, const std::string& faults) {
  return board.text + " with " + faults;
}

std::vector<PlannedStep> planned_steps(const std::vector<BoardArguments>& boards,
                                       const ConformanceArguments& arguments) {
  std::vector<PlannedStep> steps;
  for (const BoardArguments& board : boards) {
    steps.push_back({opening(board), is_simulated(board) ? 10.0 : 0.1});
    steps.push_back({board.text, 1});
    if (!arguments.each_fault) continue;
    for (const std::string& faults : each_fault()) steps.push_back({faulty_name(board, faults), 1});
  }
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

/// Its sticks are made for the checks, from the scene.
bool sends_the_scene(const BoardArguments& board) {
  return is_simulated(board) || board.link.value.ends_with("stand-in");
}

std::vector<BoardArguments> boards_of(const ConformanceArguments& arguments) {
  std::vector<BoardArguments> boards;
  for (const std::string& text : arguments.boards) {
    boards.push_back(parse_board(text));
    // What cannot be opened is refused before the folder is made; what is made for the checks takes
    // long, and comes after it.
    if (sends_the_scene(boards.back())) continue;
    open_recorded_link(boards.back());
    if (!holds_several_acquisitions(boards.back())) continue;
    throw board_refusal(text,
                        "holds several acquisitions; must be one, which acquisition=N takes "
                        "(`wobblebench inspect` lists them)");
  }
  return boards;
}

bool has_failed(const SuiteRun& run) {
  return count(run.outcomes, CheckOutcome::Kind::failed) > 0;
}

int check_boards(const ConformanceArguments& arguments) {
  const Scene scene = load_scene(arguments.scene.file, arguments.scene.settings);
  const std::vector<BoardArguments> boards = boards_of(arguments);
  const auto work = [&](OutputFolder&, Progress& progress) {
    warn_of_scan(scene, std::ranges::any_of(boards, sends_the_scene), progress);
    std::vector<SuiteRun> runs;
    for (const BoardArguments& board : boards) {
      const auto more = check_board(board, scene, arguments.each_fault, progress);
      runs.insert(runs.end(), more.begin(), more.end());
    }
    return CommandResult{.report = conformance_report(runs, scene, progress.steps()),
                         .summary = conformance_summary(runs),
                         .exit_code = std::ranges::any_of(runs, has_failed) ? kFailed : kDone,
                         .checks = test_cases(runs),
                         .document = conformance_document(runs, provenance_of_this_machine())};
  };
  return run_in_folder(arguments.output, planned_steps(boards, arguments), work);
}

}  // namespace

Command add_conformance_command(CLI::App& app) {
  const auto arguments = std::make_shared<ConformanceArguments>();
  CLI::App& command = add_subcommand(app, "conformance", "Check the board's contract on any board");
  add_scene_options(command, arguments->scene);
  add_output_options(command, arguments->output);
  add_junit_option(command, arguments->output);
  add_list(command,
           "--board",
           arguments->boards,
           "As for run, or xdma=stand-in, xdma=fifo-stand-in (repeatable)");
  add_flag(
      command, "--each-fault", arguments->each_fault, "On the board with each kind of fault, too");
  return {&command, [arguments] { return check_boards(*arguments); }};
}

}  // namespace wobblebench::bench
