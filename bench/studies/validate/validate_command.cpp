// The physics of the simulated probe against an independent sum over its elements, closed forms and
// publications.
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/near_name.h"
#include "base/user_error.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"
#include "bench/output/report.h"
#include "bench/studies/validate/validation.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  OutputArguments output;
  std::vector<std::string> studies;  ///< none: all
};

std::string study_names() {
  std::string list;
  for (const auto& study : validation_studies()) list += (list.empty() ? "" : ", ") + study.id;
  return list;
}

/// All of them, or those that were named, in the document's order.
std::vector<NamedStudy> chosen(const std::vector<std::string>& names) {
  const auto& all = validation_studies();
  for (const std::string& name : names) {
    const bool known =
        std::any_of(all.begin(), all.end(), [&](const auto& study) { return study.id == name; });
    if (known) continue;
    std::vector<std::string> ids;
    for (const auto& study : all) ids.push_back(study.id);
    throw UserError("--study = " + name + ": must be one of " + study_names() +
                    did_you_mean(name, ids));
  }
  std::vector<NamedStudy> studies;
  std::copy_if(all.begin(), all.end(), std::back_inserter(studies), [&](const auto& study) {
    return names.empty() || std::count(names.begin(), names.end(), study.id) > 0;
  });
  return studies;
}

std::string outcomes_text(const std::vector<StudyReport>& reports) {
  std::string text;
  for (const auto& report : reports) {
    for (const Check& check : report.checks) {
      text +=
          (check.passed() ? "passed  " : "FAILED  ") + check.name + "  " + describe(check) + "\n";
    }
  }
  return text;
}

/// For --junit.
std::vector<TestCase> test_cases(const std::vector<StudyReport>& reports) {
  std::vector<TestCase> cases;
  for (const auto& report : reports) {
    for (const Check& check : report.checks) {
      cases.push_back({.group = "validate." + report.id,
                       .name = check.name,
                       .failure = check.passed() ? "" : describe(check),
                       .output = check.passed() ? describe(check) : ""});
    }
  }
  return cases;
}

Json report_of(const std::vector<StudyReport>& reports,
               const Provenance& provenance,
               const StepTimes& times) {
  Json report = report_head("validate", provenance, load_scene({}, {}));
  report["checks"] = checks_json(reports);
  report["wall_ms"] = wall_json(times);
  return report;
}

CommandResult run_studies(const std::vector<NamedStudy>& studies, Progress& progress) {
  std::vector<StudyReport> reports;
  for (const auto& study : studies) {
    reports.push_back(progress.step(study.id, [&] { return run_study(study); }));
  }
  Provenance provenance = provenance_of_this_machine();
  provenance.board = "simulated";
  return {.report = report_text(report_of(reports, provenance, progress.times())),
          .summary = outcomes_text(reports),
          .exit_code = failed_checks(reports) == 0 ? kDone : kFailed,
          .checks = test_cases(reports),
          .document = validation_document(reports, provenance)};
}

int validate(const Arguments& arguments) {
  const auto studies = chosen(arguments.studies);
  std::vector<PlannedStep> steps;
  for (const auto& study : studies) steps.push_back({study.id, study.usual_s});
  return run_in_folder(arguments.output, steps, [&](OutputFolder&, Progress& progress) {
    return run_studies(studies, progress);
  });
}

}  // namespace

Command add_validate_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = add_subcommand(app,
                                     "validate",
                                     "The simulated probe's physics against an independent sum "
                                     "over its elements, closed forms and publications");
  add_output_options(command, arguments->output);
  add_junit_option(command, arguments->output);
  add_list(command,
           "--study",
           arguments->studies,
           "One study instead of all (repeatable): " + study_names());
  return {&command, [arguments] { return validate(*arguments); }};
}

}  // namespace wobblebench::bench
