// The board's contract, checked on any board; and the proof that each check can fail.
#include <iomanip>
#include <iostream>
#include <sstream>

#include "bench/checks/conformance/board_fixture.h"
#include "bench/checks/conformance/broken.h"
#include "bench/checks/conformance/suite.h"
#include "bench/cli/commands.h"
#include "bench/cli/progress.h"
#include "bench/report/output_folder.h"
#include "bench/report/report.h"

namespace wobblebench::bench {

namespace {

/// The suite on one board.
struct SuiteRun {
  std::string board;
  std::string faults;  ///< around it; empty: none but those that the board names itself
  std::vector<CheckOutcome> outcomes;
};

struct Findings {
  std::vector<SuiteRun> runs;
  std::vector<BreakageOutcome> breakages;

  bool passed() const {
    for (const SuiteRun& run : runs) {
      if (count(run.outcomes, CheckOutcome::Kind::failed) > 0) return false;
    }
    for (const BreakageOutcome& breakage : breakages) {
      if (!breakage.caught()) return false;
    }
    return true;
  }
};

Findings examine(const CommandArguments& arguments, Progress& progress) {
  const Scene scene = load_scene(arguments.scene, arguments.settings);
  std::vector<BoardArguments> boards;
  for (const std::string& text : arguments.boards) boards.push_back(parse_board(text));
  Findings findings;
  for (const BoardArguments& board : boards) {
    const ConformanceFixture fixture =
        progress.step("open " + board.text, [&] { return fixture_of(board, scene); });
    const auto add = [&](const std::string& faults, const ConformanceFixture& on) {
      const std::string name = board.text + (faults.empty() ? "" : " with " + faults);
      findings.runs.push_back(
          {board.text, faults, progress.step(name, [&] { return run_conformance(on); })});
    };
    add("", fixture);
    if (!arguments.each_fault) continue;
    for (const std::string& faults : each_fault()) add(faults, with_faults(fixture, faults));
  }
  if (arguments.broken) {
    findings.breakages = progress.step("broken boards", [] { return run_breakages(); });
  }
  return findings;
}

Json to_json(const SuiteRun& run) {
  Json checks = Json::array();
  for (const CheckOutcome& outcome : run.outcomes) {
    checks.push_back({{"board", run.board},
                      {"faults", run.faults.empty() ? Json(nullptr) : Json(run.faults)},
                      {"name", outcome.name},
                      {"rule", outcome.rule},
                      {"outcome", to_string(outcome.kind)},
                      {"detail", outcome.detail}});
  }
  return checks;
}

Json to_report(const Findings& findings, const Progress& progress, const Scene& scene) {
  Json report = report_head("conformance", provenance_of_this_machine(), scene);
  report["checks"] = Json::array();
  for (const SuiteRun& run : findings.runs) {
    for (const Json& check : to_json(run)) report["checks"].push_back(check);
  }
  report["broken"] = Json::array();
  for (const BreakageOutcome& breakage : findings.breakages) {
    report["broken"].push_back({{"check", breakage.breakage.check},
                                {"what", breakage.breakage.what},
                                {"caught", breakage.caught()},
                                {"detail", breakage.outcome.detail}});
  }
  for (const auto& [name, ms] : progress.steps()) report["wall_ms"][name] = ms;
  return report;
}

void print_run(const SuiteRun& run) {
  std::cout << "board " << run.board << (run.faults.empty() ? "" : " with ") << run.faults << ": "
            << count(run.outcomes, CheckOutcome::Kind::passed) << " passed, "
            << count(run.outcomes, CheckOutcome::Kind::failed) << " failed, "
            << count(run.outcomes, CheckOutcome::Kind::skipped) << " skipped\n";
  for (const CheckOutcome& outcome : run.outcomes) {
    const bool failed = outcome.kind == CheckOutcome::Kind::failed;
    std::cout << "  " << (failed ? "FAILED " : to_string(outcome.kind)) << "  " << std::left
              << std::setw(20) << outcome.name << "  " << outcome.detail << "\n";
  }
}

void print_breakages(const std::vector<BreakageOutcome>& breakages) {
  if (breakages.empty()) return;
  std::cout << "deliberately broken boards\n";
  for (const BreakageOutcome& breakage : breakages) {
    std::cout << "  " << (breakage.caught() ? "caught " : "MISSED ") << "  " << std::left
              << std::setw(20) << breakage.breakage.check << "  " << breakage.breakage.what << ": "
              << breakage.outcome.detail << "\n";
  }
}

std::vector<const SuiteRun*> bare_runs(const Findings& findings) {
  std::vector<const SuiteRun*> bare;
  for (const SuiteRun& run : findings.runs) {
    if (run.faults.empty()) bare.push_back(&run);
  }
  return bare;
}

/// A row a check, a column a board.
void check_table(std::ostream& page, const std::vector<const SuiteRun*>& runs) {
  page << "| check | rule |";
  for (const SuiteRun* run : runs) page << " `" << run->board << "` |";
  page << "\n| --- | --- |";
  for (std::size_t i = 0; i < runs.size(); ++i) page << " --- |";
  page << "\n";
  for (std::size_t row = 0; row < runs.front()->outcomes.size(); ++row) {
    const CheckOutcome& first = runs.front()->outcomes[row];
    page << "| `" << first.name << "` | " << first.rule << " |";
    for (const SuiteRun* run : runs) {
      const CheckOutcome& outcome = run->outcomes[row];
      page << (outcome.kind == CheckOutcome::Kind::passed   ? " passed"
               : outcome.kind == CheckOutcome::Kind::failed ? " **FAILED**: " + outcome.detail
                                                            : " skipped: " + outcome.detail)
           << " |";
    }
    page << "\n";
  }
}

/// A row a fault, a column a board: passed, failed and skipped checks.
void fault_table(std::ostream& page, const Findings& findings) {
  const auto bare = bare_runs(findings);
  page << "\n## With each fault\n\nChecks that passed, failed and were skipped; what each skip "
          "waits for stands in the report.\n\n| faults |";
  for (const SuiteRun* run : bare) page << " `" << run->board << "` |";
  page << "\n| --- |";
  for (std::size_t i = 0; i < bare.size(); ++i) page << " ---: |";
  page << "\n";
  for (const std::string& faults : each_fault()) {
    page << "| `" << faults << "` |";
    for (const SuiteRun& run : findings.runs) {
      if (run.faults != faults) continue;
      page << " " << count(run.outcomes, CheckOutcome::Kind::passed) << " / "
           << count(run.outcomes, CheckOutcome::Kind::failed) << " / "
           << count(run.outcomes, CheckOutcome::Kind::skipped) << " |";
    }
    page << "\n";
  }
}

void breakage_table(std::ostream& page, const std::vector<BreakageOutcome>& breakages) {
  page
      << "\n## Deliberately broken boards\n\nEach is broken in one way, and the check meant for it "
         "has to fail.\n\n| check | what is wrong | what the check saw |\n| --- | --- | --- |\n";
  for (const BreakageOutcome& breakage : breakages) {
    page << "| `" << breakage.breakage.check << "` | " << breakage.breakage.what << " | "
         << (breakage.caught() ? "" : "**MISSED** ") << breakage.outcome.detail << " |\n";
  }
}

std::string conformance_page(const Findings& findings, const Provenance& provenance) {
  std::ostringstream page;
  page
      << "# Conformance\n\nWritten by `wobblebench conformance`. CPU: " << provenance.cpu << ", "
      << provenance.threads << " threads. Commit: " << provenance.commit
      << ". Each check opens the board anew. No card was there: `stand-in` behaves like its driver "
         "(hw/stand_in), `fifo-stand-in` is a FIFO.\n\n";
  check_table(page, bare_runs(findings));
  if (bare_runs(findings).size() < findings.runs.size()) fault_table(page, findings);
  if (!findings.breakages.empty()) breakage_table(page, findings.breakages);
  return page.str();
}

}  // namespace

int conformance_command(const CommandArguments& arguments) {
  OutputFolder out(arguments.out);
  Progress progress;
  const Findings findings = examine(arguments, progress);
  const Json report =
      to_report(findings, progress, load_scene(arguments.scene, arguments.settings));
  out.write_text("conformance.md", conformance_page(findings, provenance_of_this_machine()));
  out.write_text("report.json", report.dump(2) + "\n");
  out.commit();
  if (arguments.json) {
    std::cout << report.dump(2) << "\n";
  } else {
    for (const SuiteRun& run : findings.runs) print_run(run);
    print_breakages(findings.breakages);
  }
  return findings.passed() ? 0 : 1;
}

}  // namespace wobblebench::bench
