// Charts: positions of ticks, lines and bars, and that nothing exceeds the picture.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "bench/output/chart/chart.h"

namespace wobblebench::bench {
namespace {

const double kGap = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string> texts(const std::vector<Tick>& ticks) {
  std::vector<std::string> result;
  for (const Tick& tick : ticks) result.push_back(tick.text);
  return result;
}

using Words = std::vector<std::string>;

TEST(Ruler, TicksAreRoundAndReadAsLittleAsTellsThemApart) {
  EXPECT_EQ(texts(Ruler({.low = 0.0, .high = 1.0}, {}).ticks(6)),
            (Words{"0.0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
  EXPECT_EQ(texts(Ruler({.low = -3.0, .high = 3.0}, {}).ticks(4)), (Words{"-2", "0", "2"}));
  EXPECT_EQ(texts(Ruler({.low = 1000.0, .high = 9000.0}, {}).ticks(5)),
            (Words{"2000", "4000", "6000", "8000"}));
}

TEST(Ruler, LogarithmicTicksStandAtOneTwoFive) {
  const Ruler few({"", Scale::logarithmic, 1.0, 30.0}, {});
  EXPECT_EQ(texts(few.ticks(7)), (Words{"1", "2", "5", "10", "20"}));
  const Ruler many({"", Scale::logarithmic, 0.01, 1e4}, {});
  EXPECT_EQ(texts(many.ticks(7)), (Words{"0.01", "0.1", "1", "10", "100", "1000", "10000"}));
  EXPECT_NEAR(few.fraction(std::sqrt(30.0)), 0.5, 1e-12);
}

TEST(Ruler, GivenTicksAreKept) {
  const Ruler given({.label = "", .ticks = {{1, "none"}, {5, "5x5"}}}, {1, 5});
  EXPECT_EQ(texts(given.ticks(7)), (Words{"none", "5x5"}));
}

TEST(Ruler, ContainsItsDataWithAMargin) {
  const Ruler ruler({}, {3, kGap, 5, 4});
  EXPECT_LT(ruler.low(), 3);
  EXPECT_GT(ruler.high(), 5);
  EXPECT_NEAR(ruler.fraction(4), 0.5, 1e-12);
  const Ruler one({}, {7});
  EXPECT_LT(one.low(), 7);
  EXPECT_GT(one.high(), 7);
  // Values that a logarithmic axis cannot show are left out.
  EXPECT_GT(Ruler({"", Scale::logarithmic}, {-1, 0, 2, 4}).low(), 1);
}

TEST(Ruler, RefusesToShowNothing) {
  EXPECT_THROW(Ruler({}, {}), std::invalid_argument);
  EXPECT_THROW(Ruler({}, {kGap}), std::invalid_argument);
  EXPECT_THROW(Ruler({"", Scale::logarithmic}, {-1}), std::invalid_argument);
}

float distance(const Colour& a, const Colour& b) {
  return std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b);
}

bool is_ink(const Colour& pixel) {
  return distance(pixel, Colour(1)) > 0.1f;
}

/// Pixels of a colour, within the box.
int count_of(const Picture3& picture, Colour colour, int left, int top, int right, int bottom) {
  int count = 0;
  for (int row = top; row < bottom; ++row) {
    for (int column = left; column < right; ++column) {
      count += distance(picture.at(column, row), colour) < 0.15f;
    }
  }
  return count;
}

int count_of(const Picture3& picture, Colour colour) {
  return count_of(picture, colour, 0, 0, picture.width, picture.height);
}

Chart two_lines() {
  Chart chart{"A title", {"place (mm)"}, {"level (dB)"}};
  chart.series.push_back({"first of the series", {0, 1, 2, 3}, {0, 1, 2, 3}});
  chart.series.push_back({"second", {0, 1, 2, 3}, {3, 2, 1, 0}, Stroke::dashed, Mark::disc});
  return chart;
}

TEST(Chart, DrawsEverySeriesInItsColour) {
  const auto picture = draw(two_lines());
  EXPECT_EQ(picture.width, PictureSize{}.width);
  EXPECT_EQ(picture.height, PictureSize{}.height);
  EXPECT_GT(count_of(picture, series_colour(0)), 200);
  EXPECT_GT(count_of(picture, series_colour(1)), 200);
  EXPECT_EQ(count_of(picture, series_colour(2)), 0);
}

TEST(Chart, NothingTouchesTheEdgeOfThePicture) {
  Chart chart = two_lines();
  chart.series[0].name = "a rather long name for a series";
  chart.series[0].y = {-123456, 1, 2, 123456};
  chart.labels.push_back({3, 123456, "a label at the right end"});
  const auto picture = draw(chart, {520, 360});
  for (int i = 0; i < picture.width; ++i) {
    for (int edge : {0, 1, picture.height - 2, picture.height - 1}) {
      EXPECT_FALSE(is_ink(picture.at(i, edge))) << "column " << i << ", row " << edge;
    }
  }
  for (int i = 0; i < picture.height; ++i) {
    for (int edge : {0, 1, picture.width - 2, picture.width - 1}) {
      EXPECT_FALSE(is_ink(picture.at(edge, i))) << "column " << edge << ", row " << i;
    }
  }
}

TEST(Chart, ALineStaysInItsPlotAndANanLeavesAGap) {
  Chart whole{"", {"x", Scale::linear, 0.0, 4.0}, {"y", Scale::linear, 0.0, 1.0}};
  whole.series.push_back({"", {0, 1, 2, 3, 4}, {0.5, 0.5, 0.5, 0.5, 0.5}});
  Chart broken = whole;
  broken.series[0].y[2] = kGap;
  Chart beyond = whole;
  beyond.series[0].y = {5, 5, 5, 5, 5};
  const int drawn = count_of(draw(whole), series_colour(0));
  EXPECT_NEAR(count_of(draw(broken), series_colour(0)), drawn / 2.0, drawn / 10.0);
  EXPECT_EQ(count_of(draw(beyond), series_colour(0)), 0);
}

TEST(Chart, RefusesSeriesWhoseNumbersDoNotMatch) {
  Chart chart = two_lines();
  chart.series[0].y.pop_back();
  EXPECT_THROW(draw(chart), std::invalid_argument);
  EXPECT_THROW(draw(Chart{}), std::invalid_argument);
}

TEST(BarChart, LengthsAreInProportion) {
  BarChart chart{"", "share (%)", {"one", "two"}, {{"a", {10, 30}}, {"b", {30, 10}}}};
  const auto picture = draw(chart, {600, 240});
  const int middle = picture.height / 2 - 10;
  // Without the legend at the right.
  const int right = 420;
  const double upper = count_of(picture, series_colour(0), 0, 0, right, middle);
  const double lower = count_of(picture, series_colour(0), 0, middle, right, picture.height);
  EXPECT_NEAR(lower / upper, 3, 0.15);
}

TEST(GreyPanels, StandBesideEachOtherWithTheirGreys) {
  GreyPanel dark{"dark", Image<float>(40, 30, 0.2f)};
  GreyPanel light{"light", Image<float>(40, 30, 0.7f)};
  const auto picture = draw({dark, light}, "what they show", 120);
  EXPECT_NEAR(count_of(picture, Colour(0.2f)), 120 * 90, 400);
  EXPECT_NEAR(count_of(picture, Colour(0.7f)), 120 * 90, 400);
  EXPECT_THROW(draw(std::vector<GreyPanel>{}, "", 100), std::invalid_argument);
}

TEST(SideBySide, KeepsEveryPixel) {
  Picture3 small(3, 2, Colour(0.5f)), tall(2, 4, Colour(0.25f));
  const auto both = side_by_side({small, tall});
  EXPECT_EQ(both.width, 5);
  EXPECT_EQ(both.height, 4);
  EXPECT_EQ(both.at(2, 1), Colour(0.5f));
  EXPECT_EQ(both.at(0, 3), Colour(1));
  EXPECT_EQ(both.at(3, 3), Colour(0.25f));
}

}  // namespace
}  // namespace wobblebench::bench
