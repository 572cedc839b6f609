// Lists of point scatterers as CSV, and the refusals of those that are none.
#include "phantoms/io/scatterer_file.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/expect.h"

namespace wobblebench::phantoms {
namespace {

std::string refusal(const std::string& csv, double gain = 1) {
  return refusal_of<std::invalid_argument>([&] { (void)scatterers_from_csv(csv, gain); });
}

constexpr char kHeader[] = "x_mm,y_mm,z_mm,amplitude\n";
constexpr char kTracks[] = "x_mm,y_mm,z_mm,amplitude,id,time_s\n";

TEST(ScattererCsv, ReadsColumnsInAnyOrderWithUnitsAndSigns) {
  const auto points = scatterers_from_csv(
      "\xef\xbb\xbf# from MUST\r\n\r\namplitude , z_mm,x_mm,y_m\r\n"
      "-0.5, 40, +1.5e1, -2e-3 # the left one\r\n 1,0,0,0");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_TRUE(points.all_fixed());
  const PointScatterer first = points.at(0, 0);
  EXPECT_EQ(first.amplitude, -0.5);
  EXPECT_DOUBLE_EQ(first.position_m.x, 15e-3);
  EXPECT_DOUBLE_EQ(first.position_m.y, -2e-3);
  EXPECT_DOUBLE_EQ(first.position_m.z, 40e-3);
  EXPECT_EQ(points.at(1, 0), (PointScatterer{{0, 0, 0}, 1}));
}

TEST(ScattererCsv, RowsOfOneIdAreATrackWhateverTheirOrder) {
  const auto points =
      scatterers_from_csv(std::string(kTracks) + "30,0,0,1,7,2\n5,5,5,0.25,3,0\n10,0,0,0.5,7,1\n");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_TRUE(points.fixed(0)) << "id 3";
  EXPECT_DOUBLE_EQ(points.at(1, 1.5).position_m.x, 20e-3);
  EXPECT_DOUBLE_EQ(points.at(1, 1.5).amplitude, 0.75);
}

TEST(ScattererCsv, TheHeaderMayBeAComment) {
  const auto points = scatterers_from_csv(
      "# written by numpy\n# x_mm,y_mm,z_mm,amplitude\n1.5e+00,2,3,0.5\n4,5,6,-1\n");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points.at(0, 0), (PointScatterer{{1.5e-3, 2e-3, 3e-3}, 0.5}));
  // A header that is none comes first.
  EXPECT_EQ(scatterers_from_csv("# x_mm,y_mm,z_mm,amplitude\nx_m,y_m,z_m,amplitude\n0.1,0,0,1\n")
                .at(0, 0),
            (PointScatterer{{0.1, 0, 0}, 1}));
  EXPECT_EQ(refusal("# x_mm,y_mm,z_mm\n1,2,3\n"), "line 1, the header: has no column amplitude");
  EXPECT_EQ(
      refusal("# x_mm,y_mm,z_mm,gain\n1,2,3,4\n").rfind("line 2: must be preceded by a header", 0),
      0u);
}

TEST(ScattererCsv, ValuesMayStandInQuotes) {
  const auto points = scatterers_from_csv(
      "\"x_mm\",\"y_mm\" , \" z_mm \",amplitude\n1,2,3,0.5\n\"4\",\"5\",\"6\",\"-1\"\r\n");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points.at(1, 0), (PointScatterer{{4e-3, 5e-3, 6e-3}, -1}));
  EXPECT_EQ(refusal("\"x_mm,y_mm,z_mm,amplitude\n1,2,3,4\n")
                .rfind("line 1, the header: column \"\"x_mm\"", 0),
            0u);
}

TEST(ScattererCsv, TheGainScalesAmplitudes) {
  EXPECT_EQ(scatterers_from_csv(std::string(kHeader) + "0,0,0,-40\n", 0.01).at(0, 0).amplitude,
            -0.4);
  EXPECT_EQ(refusal(std::string(kHeader) + "0,0,0,-40\n", 0.1),
            "line 2, column amplitude = -40: must be within -1 and 1, a perfect mirror's, after "
            "phantom.scatterers_gain_db = -20");
}

TEST(ScattererCsv, RefusalsNameLineColumnValueAndWhatIsAllowed) {
  const std::string header = kHeader;
  EXPECT_EQ(refusal(header + "\n# none\n1,2,3,0.1\n1,2,abc,0.1\n"),
            "line 5, column z_mm = abc: must be a number");
  EXPECT_EQ(refusal(header + "1,2,,0.1\n"), "line 2, column z_mm = : must be a number");
  EXPECT_EQ(refusal(header + "1,2,0x5,0.1\n"), "line 2, column z_mm = 0x5: must be a number");
  EXPECT_EQ(refusal(header + "1,2,3 4,0.1\n"), "line 2, column z_mm = 3 4: must be a number");
  EXPECT_EQ(refusal(header + "nan,2,3,0.1\n"),
            "line 2, column x_mm = nan: must be a finite number");
  EXPECT_EQ(refusal(header + "1,2,3,inf\n"),
            "line 2, column amplitude = inf: must be a finite number");
  EXPECT_EQ(refusal(header + "1,2,3,1e999\n"),
            "line 2, column amplitude = 1e999: must be a number");
  EXPECT_EQ(refusal(header + "1,-1001,3,0.1\n"),
            "line 2, column y_mm = -1001: must be within -1000 and 1000");
  EXPECT_EQ(refusal(header + "1,2,3,-1.5\n"),
            "line 2, column amplitude = -1.5: must be within -1 and 1, a perfect mirror's, after "
            "phantom.scatterers_gain_db = 0");
  EXPECT_EQ(refusal(header + "1,2,3\n"),
            "line 2: has 3 values; must have 4, one a column, separated by commas");
  EXPECT_EQ(refusal(header + "1,2,3,0.1,\n"),
            "line 2: has 5 values; must have 4, one a column, separated by commas");
}

TEST(ScattererCsv, RefusalsOfTheHeader) {
  EXPECT_EQ(refusal(""), "has no header line of column names");
  EXPECT_EQ(refusal(kHeader), "holds no scatterers");
  EXPECT_EQ(refusal("# c\n1,2,3,4\n"),
            "line 2: must be preceded by a header line of column names, such as "
            "x_mm,y_mm,z_mm,amplitude");
  EXPECT_EQ(refusal("a,b\n1,2\n"),
            "line 1, the header: column \"a\": must be one of x_mm, y_mm, z_mm (or x_m, y_m, z_m), "
            "amplitude, id, time_s");
  EXPECT_EQ(refusal("x_mm,y_mm,z_mm\n"), "line 1, the header: has no column amplitude");
  EXPECT_EQ(refusal("x_mm,y_mm,amplitude\n"), "line 1, the header: has no column z_mm");
  EXPECT_EQ(refusal("x_mm,x_m,y_mm,z_mm,amplitude\n"),
            "line 1, the header: column \"x_m\": is there twice");
  EXPECT_EQ(refusal("x_mm,y_mm,z_mm,amplitude,time_s\n"),
            "line 1, the header: column \"time_s\": makes tracks, and needs a column id");
  EXPECT_EQ(refusal("x_mm,y_mm,z_mm,amplitude,id\n"),
            "line 1, the header: column \"id\": makes tracks, and needs a column time_s");
}

TEST(ScattererCsv, RefusalsOfTracks) {
  const std::string header = kTracks;
  EXPECT_EQ(refusal(header + "0,0,0,1,1.5,0\n"), "line 2, column id = 1.5: must be a whole number");
  EXPECT_EQ(refusal(header + "0,0,0,1,-1,0\n"),
            "line 2, column id = -1: must be within 0 and 9.00719925474e+15");
  EXPECT_EQ(refusal(header + "0,0,0,1,4,0.5\n0,0,0,1,5,0.5\n0,0,0,1,4,0.5\n"),
            "line 4, column time_s = 0.5: id 4 has this time already on line 2");
}

TEST(ScattererCsv, RefusesMoreRowsThanFit) {
  std::string csv = kHeader;
  for (std::size_t i = 0; i <= kMostScattererRows; ++i) csv += "0,0,0,0\n";
  EXPECT_EQ(refusal(csv), "has more than 1000000 rows");
}

TEST(ScattererCsv, WhatIsWrittenReadsBackToTheBit) {
  PointScatterers points;
  points.add({{0.1 / 3, -1e-300, 0.7}, -1.0 / 7});
  EXPECT_EQ(scatterers_from_csv(scatterers_to_csv(points)), points);
  points.add_track({{-1.0 / 3, {{0, 0.1, 0}, 1}}, {1.0 / 3, {{0, 0.2, 0}, -1}}});
  EXPECT_EQ(scatterers_from_csv(scatterers_to_csv(points)), points);
}

}  // namespace
}  // namespace wobblebench::phantoms
