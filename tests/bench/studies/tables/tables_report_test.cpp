// Tables as Markdown, CSV and JSON.
#include "bench/studies/tables/tables_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/bench/studies/tables/made_up.h"

namespace wobblebench::bench {
namespace {

constexpr TableRun kRun{.divisor = 8, .repeats = 2, .plain_repeats = 1};

const TableResults& results() {
  static const TableResults made_up = testing::made_up_results();
  return made_up;
}

TEST(Tables, VariantsAreTheirPipelinesAndKernelSpaces) {
  using render::KernelSpace;
  using render::PipelineMode;
  const auto is = [](PipelineVariant variant, PipelineMode mode, KernelSpace space) {
    const auto options = rendered(variant, {});
    return options.pipeline.mode == mode && options.ray_casting.kernel_space == space;
  };
  EXPECT_TRUE(is(PipelineVariant::plain, PipelineMode::plain, KernelSpace::ray));
  EXPECT_TRUE(is(PipelineVariant::plain_slice, PipelineMode::plain, KernelSpace::slice));
  EXPECT_TRUE(is(PipelineVariant::fast, PipelineMode::fast, KernelSpace::slice));
  EXPECT_TRUE(is(PipelineVariant::fast_ray, PipelineMode::fast, KernelSpace::ray));
}

TEST(Tables, PowersAreFoundExactly) {
  EXPECT_NEAR(power_of({1, 2, 4}, {3, 24, 192}), 3, 1e-12);
  EXPECT_NEAR(power_of({128, 256, 384, 512}, {13.2, 15.8, 35.0, 54.6}), 1.05, 0.1);
}

TEST(Tables, EveryLineOfTheCsvHasItsCells) {
  std::istringstream lines(to_csv(results(), kRun));
  std::string line;
  std::getline(lines, line);
  const auto commas = std::count(line.begin(), line.end(), ',');
  int count = 0;
  for (; std::getline(lines, line); ++count) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), commas) << line;
  }
  EXPECT_EQ(count, 15 + 3);
}

TEST(Tables, TheReportHasTheNamesThatOthersRead) {
  nlohmann::ordered_json report;
  add_tables(report, results(), kRun, "a note");
  ASSERT_EQ(report.at("tables").size(), 4u);
  for (const auto& table : report.at("tables")) {
    EXPECT_TRUE(table.at("id").is_string());
    for (const auto& row : table.at("rows")) {
      EXPECT_TRUE(row.at("setting").is_string());
      for (const char* key : {"paper_ms", "plain_ms", "fast_ms"}) {
        EXPECT_GT(row.at(key).get<double>(), 0) << key;
      }
      EXPECT_TRUE(row.at("fast_median_interval_ms").at("coverage").is_number());
    }
  }
  EXPECT_TRUE(report.at("tables").at(1).at("exponent_of_side").at("fast").is_number());
  EXPECT_TRUE(report.at("tables").at(2).at("rows").at(0).at("fast_ray_ms").is_number());
  EXPECT_GT(report.at("arrival").at("fast").at("times_acquisition").get<double>(), 0);
  const auto& floor = report.at("floor").at("fast").at(0);
  EXPECT_EQ(floor.at("name"), "ray_casting");
  EXPECT_EQ(floor.at("fetches").at("sampler2DArray rg16 linear"), 9'000'000);
  EXPECT_EQ(report.at("run").at("note"), "a note");
}

TEST(Tables, TheMarkdownSaysWhatWasRun) {
  Provenance provenance;
  provenance.gl_backend = "egl";
  const auto markdown = to_markdown(results(), kRun, "A note.", provenance);
  for (const char* text : {"REDUCED",
                           "median of 1 (plain) and 2 (fast)",
                           "### Table IV",
                           "to the power",
                           "### What arrives",
                           "| fast | ray_casting | 9.00 | 30.0 |",
                           "| sampler2DArray rg16 linear | 300 | 900.00 | 9.00 |",
                           "A note.",
                           "GL: egl"}) {
    EXPECT_NE(markdown.find(text), std::string::npos) << text;
  }
  EXPECT_EQ(describe_run({.divisor = 1}).find("The paper's sizes."), 0u);
}

}  // namespace
}  // namespace wobblebench::bench
