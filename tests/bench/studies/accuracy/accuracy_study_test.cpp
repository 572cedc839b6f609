// Means over seeds and paired differences of rows with known values.
#include "bench/studies/accuracy/accuracy_study.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bench/studies/accuracy/accuracy_report.h"
#include "tests/support/expect.h"

namespace wobblebench::bench {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

AccuracyRow row(const std::string& setting,
                std::uint64_t seed,
                const std::string& region,
                double p95_mm) {
  std::vector<double> values(picture_measures().size(), kNone);
  values.at(measure_index("p95_mm")) = p95_mm;
  const std::string group = region == "all" ? "picture" : "incidence";
  const double render_ms = region == "all" ? (setting == "paper" ? 1.5 : 4.5) : kNone;
  return {"ball", "field", setting, seed, {group, region, values}, render_ms};
}

AccuracyResults made_up() {
  AccuracyResults results;
  results.seeds = {1, 2, 3};
  for (const std::uint64_t seed : results.seeds) {
    const double s = static_cast<double>(seed);
    results.rows.push_back(row("paper", seed, "all", 10 * s));
    results.rows.push_back(row("long", seed, "all", 10 * s - 4 + 0.1 * s));
    if (seed < 3) results.rows.push_back(row("long", seed, "0-20", s));
  }
  results.rows.push_back(row("paper", 2, "0-20", 5));
  results.summaries = summarise(results.rows, "paper");
  return results;
}

TEST(AccuracySummary, IsMeanAndPairedDifferenceOverSeeds) {
  const AccuracyResults results = made_up();
  const std::size_t p95 = measure_index("p95_mm");
  ASSERT_EQ(results.summaries.size(), 4U);
  const AccuracySummary& paper = results.summaries[0];
  const AccuracySummary& longer = results.summaries[1];
  EXPECT_DOUBLE_EQ(paper.means[p95].mean, 20);
  EXPECT_TRUE(paper.differences.empty());
  EXPECT_NEAR(longer.differences[p95].mean, -3.8, 1e-12);
  // t(0.975, 2) = 4.3027; the standard deviation of 0.1, 0.2, 0.3 is 0.1.
  EXPECT_NEAR(longer.differences[p95].half, 4.3027 * 0.1 / std::sqrt(3), 1e-4);
  EXPECT_EQ(longer.means[measure_index("ssim")].n, 0);
  EXPECT_DOUBLE_EQ(longer.render_ms.mean, 4.5);
  EXPECT_DOUBLE_EQ(longer.render_ratio.mean, 3);
  EXPECT_EQ(results.summaries[2].render_ms.n, 0);  // of a region
}

TEST(AccuracySummary, ComparesTheSeedsThatBothHave) {
  const AccuracyResults results = made_up();
  const AccuracySummary& region = results.summaries[2];
  ASSERT_EQ(region.region, "0-20");
  ASSERT_EQ(region.setting, "long");
  EXPECT_EQ(region.means[measure_index("p95_mm")].n, 2);
  EXPECT_EQ(region.differences[measure_index("p95_mm")].n, 1);
  EXPECT_EQ(region.differences[measure_index("p95_mm")].mean, -3);
}

TEST(AccuracyReport, HasARowForEachSeedAndRegion) {
  const Table rows = accuracy_document(made_up(), {}).data.front().table;
  EXPECT_EQ(rows.columns.size(), 7 + picture_measures().size());
  EXPECT_EQ(rows.rows.size(), 9U);
}

/// Of an empty box of interest nothing is scored as if it were perfect.
TEST(MeasureRows, OfNoSurfaceInViewHaveNoPercentages) {
  PictureMeasures measures;
  measures.raw.pixels = measures.filtered.pixels = 400;
  measures.raw.false_surface = 3;
  const MeasureRow whole = measure_rows(measures).front();
  for (const char* name : {"missed_percent", "missed_surface_percent", "false_percent"}) {
    EXPECT_TRUE(std::isnan(whole.values[measure_index(name)])) << name;
  }
  EXPECT_EQ(why_no_surface(measures.raw), "the phantom has none in render.volume_of_interest");
  measures.raw.shadowed = 5;
  EXPECT_TRUE(holds(why_no_surface(measures.raw), "5 shadowed"));
}

}  // namespace
}  // namespace wobblebench::bench
