// The validation documents, and the commands validate and rungs.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "bench/studies/validate/validation.h"
#include "tests/support/expect.h"
#include "tests/support/process.h"

namespace wobblebench::bench {
namespace {

using testing_support::run_process;
using testing_support::ScratchFolder;
using Words = std::vector<std::string>;

Check check(Check::Kind kind, double measured, double expected, double tolerance) {
  return {
      "study.what", kind, measured, expected, tolerance, "mm", "closed form", 5, "places", {1, 2}};
}

TEST(Check, PassesWithinWhatItAllows) {
  EXPECT_TRUE(check(Check::Kind::within, 1.09, 1, 0.1).passed());
  EXPECT_FALSE(check(Check::Kind::within, 0.89, 1, 0.1).passed());
  EXPECT_TRUE(check(Check::Kind::at_least, 1, 1, 0).passed());
  EXPECT_FALSE(check(Check::Kind::at_least, 0.99, 1, 0).passed());
  EXPECT_TRUE(check(Check::Kind::at_most, 1, 1, 0).passed());
  EXPECT_FALSE(check(Check::Kind::at_most, 1.01, 1, 0).passed());
  for (const auto kind : {Check::Kind::within, Check::Kind::at_least, Check::Kind::at_most}) {
    EXPECT_FALSE(check(kind, std::nan(""), 1, 0.1).passed());
  }
}

TEST(Validation, WhatAStudyThrowsIsACheckThatFailed) {
  const auto report =
      run_study({"broken", "Broken", 1, []() -> StudyReport { throw std::runtime_error("a\nb"); }});
  ASSERT_EQ(report.checks.size(), 1u);
  EXPECT_FALSE(report.checks.front().passed());
  EXPECT_EQ(report.checks.front().name, "broken.ran");
  EXPECT_EQ(failed_checks({report}), 1);
  EXPECT_TRUE(holds(markdown(validation_document({report}, {})), "a\\nb"));
}

StudyReport example() {
  StudyReport report{"study", "A study", "What was done.", {}, {}, {}};
  report.checks = {check(Check::Kind::within, 1.05, 1, 0.1), check(Check::Kind::at_most, 3, 2, 0)};
  report.points = {{"a, b", "x_mm", 1.5, "y_db", -2, {}}, {"c", "x_mm", 2, "y_db", -3, 4.0}};
  report.figures = {{"chart", "A caption.", {Chart{.title = "A chart"}}}};
  return report;
}

TEST(Validation, DocumentNamesFailuresAndHasEveryPoint) {
  const auto document = validation_document({example()}, {.commit = "abc"});
  const auto text = markdown(document);
  for (const char* part : {"2 checks, 1 passed, 1 failed",
                           "- `study.what`: 3 mm; expected",
                           "](validation_chart.vl.json)",
                           "Commit abc",
                           "1.05 mm | 1 ± 0.1",
                           "tests/yardstick",
                           "## Not modelled"}) {
    EXPECT_TRUE(holds(text, part)) << part << " in ";
  }
  ASSERT_EQ(document.data.size(), 1u);
  EXPECT_EQ(csv(document.data.front().table),
            "study,series,x_name,x,y_name,y,expected\n"
            "study,\"a, b\",x_mm,1.5,y_db,-2,\n"
            "study,c,x_mm,2,y_db,-3,4\n");
}

TEST(Validation, ReportHasNameOutcomeDetail) {
  const auto checks = checks_json({example()});
  ASSERT_EQ(checks.size(), 2u);
  EXPECT_EQ(checks[0].at("name"), "study.what");
  EXPECT_EQ(checks[0].at("outcome"), "passed");
  EXPECT_EQ(checks[1].at("outcome"), "failed");
  EXPECT_EQ(checks[0].at("detail"),
            "1.05 mm; expected 1 ± 0.1 mm (closed form); n = 5 places; seeds 1 to 2");
}

TEST(ValidateCommand, WritesMarkdownPointsFiguresAndReport) {
  const ScratchFolder folder;
  const auto result =
      run_process(WOBBLEBENCH_PROGRAM, words_of("validate --study shear --json"), folder.path());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(
      folder.files("out"),
      words_of("report.html report.json validation.csv validation.md validation_shear.vl.json"));
  const auto report = nlohmann::json::parse(result.out);
  EXPECT_EQ(report.at("command"), "validate");
  EXPECT_EQ(report.at("checks").size(), 3u);
}

TEST(ValidateCommand, RefusesAnUnknownStudy) {
  const ScratchFolder folder;
  const auto result =
      run_process(WOBBLEBENCH_PROGRAM, words_of("validate --study weather"), folder.path());
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err.find("wobblebench: --study = weather: must be one of speckle, "), 0u)
      << result.err;
  EXPECT_TRUE(folder.files("out").empty());
}

TEST(RungsCommand, RefusesWhatItSetsItself) {
  const ScratchFolder folder;
  const auto result = run_process(
      WOBBLEBENCH_PROGRAM, words_of("rungs --set simulation.fidelity=field"), folder.path());
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err.find("wobblebench: simulation.fidelity: is set by the command"), 0u)
      << result.err;
}

}  // namespace
}  // namespace wobblebench::bench
