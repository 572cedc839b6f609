#include "bench/cli/conformance_report.h"

#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "bench/board_checks/conformance/suite.h"
#include "bench/output/report.h"

namespace wobblebench::bench {

namespace {

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

void write_defects(std::ostream& text, const std::vector<DefectOutcome>& defects) {
  if (defects.empty()) return;
  text << "deliberately broken boards\n";
  for (const DefectOutcome& defect : defects) {
    text << "  " << (defect.detected() ? "caught " : "MISSED ") << "  " << std::left
         << std::setw(20) << defect.defect.check << "  " << defect.defect.what << ": "
         << defect.outcome.detail << "\n";
  }
}

std::vector<const SuiteRun*> bare_runs(const ConformanceFindings& findings) {
  std::vector<const SuiteRun*> bare;
  for (const SuiteRun& run : findings.runs) {
    if (run.faults.empty()) bare.push_back(&run);
  }
  return bare;
}

/// A row for each check, a column for each board.
void check_table(std::ostream& text, const std::vector<const SuiteRun*>& runs) {
  text << "| check | rule |";
  for (const SuiteRun* run : runs) text << " `" << run->board << "` |";
  text << "\n| --- | --- |";
  for (std::size_t i = 0; i < runs.size(); ++i) text << " --- |";
  text << "\n";
  for (std::size_t row = 0; row < runs.front()->outcomes.size(); ++row) {
    const CheckOutcome& first = runs.front()->outcomes[row];
    text << "| `" << first.name << "` | " << first.rule << " |";
    for (const SuiteRun* run : runs) {
      const CheckOutcome& outcome = run->outcomes[row];
      text << (outcome.kind == CheckOutcome::Kind::passed   ? " passed"
               : outcome.kind == CheckOutcome::Kind::failed ? " **FAILED**: " + outcome.detail
                                                            : " skipped: " + outcome.detail)
           << " |";
    }
    text << "\n";
  }
}

/// A row for each fault, a column for each board: passed, failed and skipped checks.
void fault_table(std::ostream& text, const ConformanceFindings& findings) {
  const auto bare = bare_runs(findings);
  text << "\n## With each fault\n\nChecks that passed, failed and were skipped; what each skip "
          "waits for stands in the report.\n\n| faults |";
  for (const SuiteRun* run : bare) text << " `" << run->board << "` |";
  text << "\n| --- |";
  for (std::size_t i = 0; i < bare.size(); ++i) text << " ---: |";
  text << "\n";
  for (const std::string& faults : each_fault()) {
    text << "| `" << faults << "` |";
    for (const SuiteRun& run : findings.runs) {
      if (run.faults != faults) continue;
      text << " " << count(run.outcomes, CheckOutcome::Kind::passed) << " / "
           << count(run.outcomes, CheckOutcome::Kind::failed) << " / "
           << count(run.outcomes, CheckOutcome::Kind::skipped) << " |";
    }
    text << "\n";
  }
}

void defect_table(std::ostream& text, const std::vector<DefectOutcome>& defects) {
  text
      << "\n## Deliberately broken boards\n\nEach is broken in one way, and the check meant for it "
         "has to fail.\n\n| check | what is wrong | what the check saw |\n| --- | --- | --- |\n";
  for (const DefectOutcome& defect : defects) {
    text << "| `" << defect.defect.check << "` | " << defect.defect.what << " | "
         << (defect.detected() ? "" : "**MISSED** ") << defect.outcome.detail << " |\n";
  }
}

}  // namespace

std::string conformance_report(const ConformanceFindings& findings,
                               const Scene& scene,
                               const StepTimes& times) {
  Json report = report_head("conformance", provenance_of_this_machine(), scene);
  report["checks"] = Json::array();
  for (const SuiteRun& run : findings.runs) {
    for (const Json& check : to_json(run)) report["checks"].push_back(check);
  }
  report["broken"] = Json::array();
  for (const DefectOutcome& defect : findings.defects) {
    report["broken"].push_back({{"check", defect.defect.check},
                                {"what", defect.defect.what},
                                {"caught", defect.detected()},
                                {"detail", defect.outcome.detail}});
  }
  report["wall_ms"] = wall_json(times);
  return report_text(report);
}

std::string conformance_markdown(const ConformanceFindings& findings,
                                 const Provenance& provenance) {
  std::ostringstream text;
  text
      << "# Conformance\n\nWritten by `wobblebench conformance`. CPU: " << provenance.cpu << ", "
      << provenance.threads << " threads. Commit: " << provenance.commit
      << ". Each check opens the board anew. No card was there: `stand-in` behaves like its driver "
         "(hw/emulator), `fifo-stand-in` is a FIFO.\n\n";
  check_table(text, bare_runs(findings));
  if (bare_runs(findings).size() < findings.runs.size()) fault_table(text, findings);
  if (!findings.defects.empty()) defect_table(text, findings.defects);
  return text.str();
}

std::string conformance_summary(const ConformanceFindings& findings) {
  std::ostringstream text;
  for (const SuiteRun& run : findings.runs) write_run(text, run);
  write_defects(text, findings.defects);
  return text.str();
}

}  // namespace wobblebench::bench
