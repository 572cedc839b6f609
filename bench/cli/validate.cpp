// The physics of the simulated probe against closed forms and publications.
#include <algorithm>
#include <iostream>

#include "bench/cli/commands.h"
#include "bench/cli/progress.h"
#include "bench/cli/user_error.h"
#include "bench/report/image_io.h"
#include "bench/report/output_folder.h"
#include "bench/report/report.h"
#include "bench/report/validation/validation.h"

namespace wobblebench::bench {

namespace {

/// All of them, or those that were named, in the page's order.
std::vector<NamedStudy> chosen(const std::vector<std::string>& names) {
  const auto& all = validation_studies();
  for (const std::string& name : names) {
    const bool known =
        std::any_of(all.begin(), all.end(), [&](const auto& study) { return study.id == name; });
    if (known) continue;
    std::string list;
    for (const auto& study : all) list += (list.empty() ? "" : ", ") + study.id;
    throw UserError("--study = " + name + ": must be one of " + list);
  }
  std::vector<NamedStudy> studies;
  std::copy_if(all.begin(), all.end(), std::back_inserter(studies), [&](const auto& study) {
    return names.empty() || std::count(names.begin(), names.end(), study.id) > 0;
  });
  return studies;
}

void print_outcomes(const std::vector<StudyReport>& reports) {
  for (const auto& report : reports) {
    for (const Check& check : report.checks) {
      std::cout << (check.passed() ? "passed  " : "FAILED  ") << check.name << "  "
                << describe(check) << "\n";
    }
  }
}

}  // namespace

int validate_command(const CommandArguments& arguments) {
  const auto studies = chosen(arguments.studies);
  OutputFolder out(arguments.out);
  Progress progress;
  std::vector<StudyReport> reports;
  for (const auto& study : studies) {
    reports.push_back(progress.step(study.id, [&] { return run_study(study); }));
  }

  Provenance provenance = provenance_of_this_machine();
  provenance.board = "simulated";
  Json report = report_head("validate", provenance, load_scene({}, {}));
  report["checks"] = checks_json(reports);
  for (const auto& [name, ms] : progress.steps()) report["wall_ms"][name] = ms;
  report["wall_ms"]["total"] = progress.total_ms();

  out.write_text("validation.md", validation_markdown(reports, provenance, arguments.figure_path));
  out.write_text("validation.csv", validation_csv(reports));
  for (const auto& study : reports) {
    for (const Figure& figure : study.figures) {
      write_png(out.stage(figure_file(figure)), figure.picture);
    }
  }
  out.write_text("report.json", report.dump(2) + "\n");
  out.commit();
  if (arguments.json) {
    std::cout << report.dump(2) << "\n";
  } else {
    print_outcomes(reports);
  }
  return failed_checks(reports) == 0 ? 0 : 1;
}

}  // namespace wobblebench::bench
