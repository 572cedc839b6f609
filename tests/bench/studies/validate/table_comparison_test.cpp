// The worst of many places against the yardstick's tables.
#include "bench/studies/validate/common/study_report.h"

#include <gtest/gtest.h>

#include <cmath>

namespace wobblebench::bench {
namespace {

BeamComparison place(double fraction, double range_mm, double table_mm, double found_mm) {
  BeamComparison one;
  one.expected.sector_fraction = fraction;
  one.expected.range_m = range_mm * 1e-3;
  one.expected.lateral_m = table_mm * 1e-3;
  one.expected.level_db = -table_mm;
  one.measured = one.expected;
  one.measured.lateral_m = found_mm * 1e-3;
  one.measured.level_db = -found_mm;
  return one;
}

TEST(TableComparison, NamesThePlaceOfTheLargestRelativeError) {
  // Absolutely the second is off by most, relatively the third, downwards.
  const std::vector<BeamComparison> found = {
      place(0, 30, 2, 2.02), place(0.4, 40, 8, 8.2), place(0.88, 50, 1, 0.96)};
  const Check check = worst_width("a", found, kLateral, 5);
  EXPECT_NEAR(check.measured, 4, 1e-9);
  EXPECT_EQ(check.source, "worst at 50 mm, 0.88 of the half sector: 0.96 mm, table 1 mm");
  EXPECT_EQ(check.n, 3);
  EXPECT_TRUE(check.passed());
  EXPECT_FALSE(worst_width("a", found, kLateral, 3.9).passed());
}

TEST(TableComparison, LevelsDifferInDecibels) {
  const std::vector<BeamComparison> found = {place(0, 30, 2, 2.02), place(0, 40, 8, 8.2)};
  const Check check = worst_level("a", found, 0.1);
  EXPECT_NEAR(check.measured, 0.2, 1e-9);
  EXPECT_EQ(check.source, "worst at 40 mm: -8.20 dB, table -8.00 dB");
  EXPECT_FALSE(check.passed());
}

TEST(TableComparison, WhatIsNoNumberFails) {
  const std::vector<BeamComparison> found = {
      place(0, 30, 2, 3), place(0, 40, 2, std::nan("")), place(0, 50, 2, 2)};
  EXPECT_FALSE(worst_width("a", found, kLateral, 1000).passed());
  EXPECT_FALSE(worst_width("a", {}, kLateral, 1000).passed());
  StudyReport report;
  add_points("a", found, report);
  for (const DataPoint& point : report.points) EXPECT_FALSE(std::isnan(point.y));
}

TEST(TableComparison, TheAxisIsTheMiddleStick) {
  const std::vector<BeamComparison> found = {
      place(0, 20, 1, 1), place(0, 30, 1, 1), place(0.4, 30, 1, 1), place(1, 160, 1, 1)};
  EXPECT_EQ(at_places(found, StickPlaces::axis, 30e-3, 160e-3).size(), 1u);
  EXPECT_EQ(at_places(found, StickPlaces::edge, 30e-3, 160e-3).size(), 2u);
  EXPECT_EQ(at_places(found, StickPlaces::edge, 30e-3, 150e-3).size(), 1u);
}

}  // namespace
}  // namespace wobblebench::bench
