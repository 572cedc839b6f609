// The tables of tests/yardstick as the program has them, and how they are read.
#include "bench/studies/validate/common/yardstick.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "bench/studies/validate/losses/losses.h"
#include "tests/support/expect.h"

namespace wobblebench::bench {
namespace {

std::string what_is_wrong_with(const std::string& text) {
  return refusal_of<std::invalid_argument>([&] {
    const CsvTable table(text);
    for (std::size_t i = 0; i < table.rows(); ++i) table.number(i, "mm");
  });
}

TEST(CsvTable, HasTextAndNumbersByColumn) {
  const CsvTable table("# about, this\nname,mm\na,1.5\n\nb,-2e1");
  ASSERT_EQ(table.rows(), 2u);
  EXPECT_EQ(table.text(0, "name"), "a");
  EXPECT_DOUBLE_EQ(table.number(0, "mm"), 1.5);
  EXPECT_DOUBLE_EQ(table.number(1, "mm"), -20);
}

TEST(CsvTable, SaysWhatIsWrong) {
  EXPECT_EQ(what_is_wrong_with("# only\n"), "a table without a heading");
  EXPECT_EQ(what_is_wrong_with("name,mm\na,1\nb\n"), "line 3: 1 fields where the heading has 2");
  EXPECT_EQ(what_is_wrong_with("name,mm\na,1,2\n"), "line 2: 3 fields where the heading has 2");
  EXPECT_EQ(what_is_wrong_with("name\na\n"), "no column mm");
  EXPECT_EQ(what_is_wrong_with("name,mm\na,1x\n"), "mm = 1x: not a number");
  EXPECT_EQ(what_is_wrong_with("name,mm\na,\n"), "mm = : not a number");
}

TEST(Yardstick, HasEveryPresetAngleAndDepth) {
  for (const hw::ProbePreset preset : kPresets) {
    for (const auto& rows : {point_width_rows(preset), speckle_rows(preset)}) {
      std::set<double> fractions, ranges_m;
      for (const BeamRow& row : rows) {
        fractions.insert(row.sector_fraction);
        ranges_m.insert(row.range_m);
        EXPECT_NEAR(
            row.theta_rad, row.sector_fraction * 0.5 * hw::probe_preset(preset).sector_rad, 1e-4);
        if (row.sector_fraction == 0) {
          EXPECT_EQ(row.level_db, 0);
        }
      }
      EXPECT_EQ(rows.size(), fractions.size() * ranges_m.size());
      EXPECT_EQ(ranges_m.size(), 11u);
      EXPECT_EQ(fractions.size(), preset == hw::ProbePreset::standard ? 5u : 4u);
    }
  }
}

/// Lines of the files, by eye: standard,1,90,38.5,3.4968,2.7604,0.33063,-14.821 and its middle
/// stick's -2.7835.
TEST(Yardstick, RowsAreInMetresAndLevelsOverTheMiddleStick) {
  for (const BeamRow& row : point_width_rows(hw::ProbePreset::standard)) {
    if (row.sector_fraction != 1 || row.range_m < 85e-3 || row.range_m > 95e-3) continue;
    EXPECT_DOUBLE_EQ(row.range_m, 90e-3);
    EXPECT_DOUBLE_EQ(row.lateral_m, 3.4968e-3);
    EXPECT_DOUBLE_EQ(row.elevation_m, 2.7604e-3);
    EXPECT_DOUBLE_EQ(row.axial_m, 0.33063e-3);
    EXPECT_NEAR(row.level_db, -14.821 + 2.7835, 1e-9);
    return;
  }
  FAIL() << "no such row";
}

TEST(Yardstick, AxisLevelIsLinearBetweenDepths) {
  EXPECT_NEAR(axis_level_db(hw::ProbePreset::standard, 75e-3), 0, 1e-9);
  EXPECT_NEAR(axis_level_db(hw::ProbePreset::standard, 90e-3), -2.7835, 1e-9);
  EXPECT_NEAR(axis_level_db(hw::ProbePreset::standard, 80e-3), -2.7835 / 3, 1e-9);
  EXPECT_NEAR(axis_level_db(hw::ProbePreset::standard, 19e-3), -24.427 - 0.381, 1e-9) << "beyond";
}

TEST(Yardstick, EchoPlacesHavePointsAndEnvelopes) {
  const auto places = echo_places();
  ASSERT_EQ(places.size(), 25u);
  for (const EchoPlace& place : places) {
    EXPECT_EQ(place.points.size(), 40u);
    EXPECT_EQ(place.ranges_m.size(), 64u);
    EXPECT_EQ(place.envelope.size(), 64u);
    EXPECT_NEAR(0.5 * (place.ranges_m.front() + place.ranges_m.back()), place.range_m, 1e-6);
  }
  EXPECT_DOUBLE_EQ(places[0].points[0].axial_m, 30.208e-3);
  EXPECT_DOUBLE_EQ(places[0].points[0].elevation_m, -2.945e-3);
  EXPECT_DOUBLE_EQ(places[0].envelope[1], 0.0014181);
}

TEST(Yardstick, OnTheAxisAStickOwnsTheBeamThatSticksThatTurnShow) {
  for (const hw::ProbePreset preset : kPresets) {
    const auto own = stick_beam_rows(preset), turned = point_width_rows(preset);
    ASSERT_EQ(own.size(), turned.size());
    for (std::size_t i = 0; i < own.size(); ++i) {
      EXPECT_EQ(own[i].range_m, turned[i].range_m);
      // Without the array's end in the aperture both are the same.
      if (own[i].sector_fraction == 0) {
        EXPECT_NEAR(own[i].lateral_m / turned[i].lateral_m, 1, 0.02);
      }
    }
  }
  EXPECT_DOUBLE_EQ(stick_beam_rows(hw::ProbePreset::standard)[45].lateral_m, 4.0099e-3);
}

TEST(Yardstick, AttenuatedRowsAndShadowsAreInMetres) {
  const auto rows = attenuated_rows(0.5);
  ASSERT_EQ(rows.size(), 11u);
  EXPECT_DOUBLE_EQ(rows[5].range_m, 75e-3);
  EXPECT_DOUBLE_EQ(rows[5].lateral_m, 2.0543e-3);
  EXPECT_DOUBLE_EQ(rows[5].axial_m, 0.33321e-3);
  EXPECT_DOUBLE_EQ(rows[5].level_db, -23.387);
  const auto shadows = shadow_rows();
  ASSERT_EQ(shadows.size(), 2u * 5u * 49u);
  const ShadowRow& row = shadows[(5 + 3) * 49 + 28];
  EXPECT_FALSE(row.across_lines);
  EXPECT_DOUBLE_EQ(row.range_m, 100e-3);
  EXPECT_DOUBLE_EQ(row.crossing_m, 2e-3);
  EXPECT_DOUBLE_EQ(row.level_db, -20.036);
  EXPECT_DOUBLE_EQ(row.rise_m, 4.0437e-3);
}

TEST(ShadowEdge, RiseIsFromATenthToNineTenthsOfTheStep) {
  // Amplitude 1 up to -2 mm, then down along a line to 0.2 at 2 mm.
  std::vector<double> crossing_m, level_db;
  for (int i = -10; i <= 10; ++i) {
    crossing_m.push_back(i * 0.5e-3);
    const double share = std::clamp((2 - i * 0.5) / 4, 0.0, 1.0);
    level_db.push_back(20 * std::log10(0.2 + 0.8 * share));
  }
  EXPECT_NEAR(rise_m(crossing_m, level_db), 0.8 * 4e-3, 1e-9);
}

TEST(Yardstick, NeighboursAreCorrelations) {
  const auto rows = neighbour_rows();
  ASSERT_EQ(rows.size(), 11u);
  EXPECT_DOUBLE_EQ(rows[0].line_correlation, 0.28416);
  EXPECT_DOUBLE_EQ(rows[0].frame_correlation, 0.00064135);
}

}  // namespace
}  // namespace wobblebench::bench
