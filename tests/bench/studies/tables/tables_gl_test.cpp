// The tables measured on noise, an eighth of the paper's size.
#include "bench/studies/tables/measure.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/bench/studies/tables/recording.h"

namespace wobblebench::bench {
namespace {

TableVolumes noise() {
  const auto plan = testing::recorded_plan();
  hw::PolarVolume volume(plan);
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(plan.sticks_per_volume()); ++i) {
    volume.place(hw::test_stick(plan, i));
  }
  TableVolumes volumes;
  for (const int frames : frame_counts()) {
    volumes.by_frames.emplace(frames, middle_frames(volume, frames));
  }
  return volumes;
}

void expect_ratios_to_the_reference(const TableResults& results) {
  for (const MeasuredTable& table : results.tables) {
    for (const MeasuredRow& row : table.rows) {
      EXPECT_NEAR(row.paper_ratio, row.row.paper_ms / 54.6, 1e-12);
      EXPECT_NEAR(
          row.speed_up() * row.ms(PipelineVariant::fast), row.ms(PipelineVariant::plain), 1e-9);
      for (const PipelineVariant variant : {PipelineVariant::plain, PipelineVariant::fast}) {
        EXPECT_GT(row.ms(variant), 0);
        // Each repeat's ratio lies within what its two times can make.
        const Spread& ms = row.timings.at(variant).frame_ms;
        const Spread& reference = results.reference.timings.at(variant).frame_ms;
        EXPECT_GE(row.timings.at(variant).ratio.lower, ms.min / reference.max * (1 - 1e-12));
        EXPECT_LE(row.timings.at(variant).ratio.upper, ms.max / reference.min * (1 + 1e-12));
        EXPECT_EQ(row.timings.at(variant).passes.size(), 4u);
      }
    }
  }
}

void expect_a_shared_setting_measured_once(const TableResults& results) {
  for (const PipelineVariant variant : {PipelineVariant::plain, PipelineVariant::fast}) {
    const MeasuredRow& last_of_i = results.tables.at(0).rows.back();
    EXPECT_EQ(last_of_i.ms(variant), results.tables.at(1).rows.front().ms(variant));
    EXPECT_EQ(last_of_i.timings.at(variant).ratio.lower, 1);
    EXPECT_EQ(last_of_i.timings.at(variant).ratio.upper, 1);
  }
}

void expect_kernel_spaces_where_the_kernel_varies(const TableResults& results) {
  for (const MeasuredTable& table : results.tables) {
    const bool kernel = table.table.id == "III";
    for (const MeasuredRow& row : table.rows) EXPECT_EQ(row.timings.size(), kernel ? 4u : 2u);
    EXPECT_EQ(table.exponents.has_value(), table.table.id == "II");
  }
}

void expect_arrivals_that_add_up(const TableResults& results) {
  for (const PipelineVariant variant : {PipelineVariant::plain, PipelineVariant::fast}) {
    const Arrival& arrival = results.arrival(variant);
    EXPECT_GT(arrival.add_frame_ms.median, 0);
    EXPECT_GT(arrival.new_view_ms.median, 0);
  }
}

void expect_stages_of_two_settings_and_two_numbers_of_frames(const TableResults& results) {
  ASSERT_EQ(results.stages.size(), 4u);
  for (const char* settings : {"paper", "default"}) {
    EXPECT_EQ(std::ranges::count(results.stages, settings, &StageTimes::settings), 2) << settings;
  }
  for (const StageTimes& times : results.stages) {
    EXPECT_TRUE(times.frames == 37 || times.frames == 27);
    EXPECT_EQ(times.frame_ms.size(), 2 * static_cast<std::size_t>(times.frames - 1));
    for (const auto* values : {&times.last_frame_ms, &times.picture_ms, &times.new_view_ms}) {
      EXPECT_EQ(values->size(), 2u);
      EXPECT_GT(*std::ranges::min_element(*values), 0);
    }
  }
}

// One test: each is a process of its own, and most of the time goes into compiling shaders.
TEST(Tables, AreMeasuredInEveryVariantTheyName) {
  const auto context = render::make_context();
  const TableResults results =
      measure_tables(noise(), {}, *context, {.divisor = 8, .repeats = 2, .plain_repeats = 1});
  expect_ratios_to_the_reference(results);
  expect_a_shared_setting_measured_once(results);
  expect_kernel_spaces_where_the_kernel_varies(results);
  expect_arrivals_that_add_up(results);
  expect_stages_of_two_settings_and_two_numbers_of_frames(results);
  EXPECT_NEAR(
      results.frame_acquisition_ms, 8 * testing::recorded_plan().stick_period_s() * 1e3, 1e-6);
}

TEST(Tables, ListThePapersTimes) {
  const std::vector<std::vector<double>> paper = {{53.7, 54.0, 54.6, 54.6},
                                                  {54.6, 35.0, 15.8, 13.2},
                                                  {21.5, 54.6, 187},
                                                  {54.3, 54.9, 55.5, 56.8}};
  ASSERT_EQ(paper_tables().size(), paper.size());
  for (std::size_t t = 0; t < paper.size(); ++t) {
    std::vector<double> listed;
    for (const TableRow& row : paper_tables()[t].rows) listed.push_back(row.paper_ms);
    EXPECT_EQ(listed, paper[t]);
  }
}

}  // namespace
}  // namespace wobblebench::bench
