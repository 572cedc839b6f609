// Tables as a document and as report.json.
#include "bench/studies/tables/tables_report.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "bench/studies/tables/tables_rows.h"
#include "tests/bench/studies/tables/made_up.h"
#include "tests/support/expect.h"

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

/// The cell of a row, by the key of its column.
const Cell& cell(const Table& table, std::size_t row, const std::string& key) {
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (table.columns[i].key == key) return table.rows.at(row).at(i);
  }
  throw std::logic_error("no column " + key);
}

TEST(Tables, EveryRowHasItsTimesAndTheSideThatWasRun) {
  const Table rows = all_rows(results(), kRun);
  ASSERT_EQ(rows.rows.size(), 15u + 3);
  // Row 4 is 512^3 of Table II: with 37 frames and 3x3x3, plain takes 200 + 620 * 9 ms.
  EXPECT_EQ(cell(rows, 4, "setting").text(), "512^3");
  EXPECT_EQ(cell(rows, 4, "side").number(), 64);
  EXPECT_DOUBLE_EQ(cell(rows, 4, "plain_ms").number(), 5780);
  EXPECT_DOUBLE_EQ(cell(rows, 4, "plain_ms").high(), 1.03 * 5780);
  EXPECT_DOUBLE_EQ(cell(rows, 4, "plain_ray_casting_ms").number(), 0.7 * 5780);
  EXPECT_FALSE(cell(rows, 4, "fast_ray_ms").is_number());
  EXPECT_TRUE(cell(rows, 8, "fast_ray_ms").is_number());
  EXPECT_EQ(cell(rows, 15, "setting").text(), "one frame");
  EXPECT_DOUBLE_EQ(cell(rows, 15, "fast_times_acquisition").number(), 13.3 / 1.25);
}

TEST(Tables, ChartsShowTheSidesThatWereRun) {
  const auto figures = tables_figures(results(), kRun);
  ASSERT_EQ(figures.size(), 2u);
  const auto& chart = std::get<Chart>(figures[0].panels.at(1));
  ASSERT_EQ(chart.series.size(), 3u);
  EXPECT_EQ(chart.series[0].x, (std::vector<double>{16, 32, 48, 64}));
  EXPECT_EQ(chart.x.ticks, (std::vector<double>{64, 48, 32, 16}));
}

TEST(Tables, TheReportHasTheNamesThatOthersRead) {
  nlohmann::ordered_json report;
  add_tables(report, results(), kRun, "a note", tables_document(results(), kRun, "", {}));
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
  EXPECT_GT(report.at("arrival").at(0).at("fast_times_acquisition").get<double>(), 0);
  EXPECT_EQ(report.at("floor").back().at("pass"), "ray_casting");
  EXPECT_EQ(report.at("floor").back().at("fetches_millions"), 9);
  EXPECT_EQ(report.at("fetches").at(0).at("fetch"), "sampler2DArray rg16 linear");
  EXPECT_EQ(report.at("run").at("note"), "a note");
}

TEST(Tables, TheDocumentSaysWhatWasRun) {
  Provenance provenance;
  provenance.gl_backend = "egl";
  const auto text = markdown(tables_document(results(), kRun, "A note.", provenance));
  for (const char* part : {"REDUCED",
                           "median of 1 (plain) and 2 (fast)",
                           "## Table IV",
                           "to the power 1.05 (paper), 2.80 (plain), 1.40 (fast)",
                           "## What arrives",
                           "| fast | ray_casting | 9.00 | 30 |",
                           "| sampler2DArray rg16 linear | 300 | 900.00 | 9.00 |",
                           "A note.",
                           "GL: egl"}) {
    EXPECT_TRUE(holds(text, part)) << part;
  }
  EXPECT_EQ(describe_run({.divisor = 1}).find("The paper's sizes."), 0u);
}

}  // namespace
}  // namespace wobblebench::bench
