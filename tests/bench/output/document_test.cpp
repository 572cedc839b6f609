// One writer each of tables, charts and documents: known texts, written by hand.
#include "bench/output/document/document.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace wobblebench::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Table passes() {
  Table table{
      .name = "passes",
      .columns = {
          {"pass"}, {"median_ms", "time", "ms", 1}, {"rms_mm", "RMS", "mm", 2}, {"n", "", "", 0}}};
  table.add({"filter", Cell::spread(4.25, 4.0, 5.125), Cell::interval(1.25, 0.125), 12});
  table.add({Cell::code("ray|casting"), kNone, Cell(-0.005).bracket(), 1000000});
  return table;
}

TEST(Table, AsMarkdown) {
  EXPECT_EQ(markdown(passes()),
            "| pass | time, ms | RMS, mm | n |\n"
            "| --- | ---: | ---: | ---: |\n"
            "| filter | 4.2 (4.0 to 5.1) | 1.25 ± 0.12 | 12 |\n"
            "| `ray\\|casting` |  | (-0.01) | 1000000 |\n");
}

TEST(Table, AsCsvHasTheEndsOfRangesAndQuotesWhatNeedsIt) {
  Table table = passes();
  table.add({"a \"b\", c\nd", std::numeric_limits<double>::infinity(), 1.0 / 3, 0});
  EXPECT_EQ(csv(table),
            "pass,median_ms,median_ms_low,median_ms_high,rms_mm,rms_mm_low,rms_mm_high,n\n"
            "filter,4.25,4,5.125,1.25,1.125,1.375,12\n"
            "ray|casting,,,,-0.005,,,1000000\n"
            "\"a \"\"b\"\", c\nd\",,,,0.333333333,,,0\n");
}

TEST(Table, AsJsonHasNullForWhatIsNotKnown) {
  const Json rows = to_json(passes());
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0]["median_ms"], (Json{{"value", 4.25}, {"low", 4.0}, {"high", 5.125}}));
  EXPECT_TRUE(rows[1]["median_ms"].is_null());
  EXPECT_EQ(rows[1]["n"], 1000000);
}

TEST(Table, SignificantDigitsSuitValuesOfManySizes) {
  const Column column{"ms", "time", "ms", 3, true};
  EXPECT_EQ(Cell(0.0123456).shown(column), "0.0123");
  EXPECT_EQ(Cell(123.456).shown(column), "123");
  EXPECT_EQ(Cell(5780.4).shown(column), "5780");
  EXPECT_EQ(Cell(2.5e8).shown(column), "2.5e+08");
  EXPECT_EQ(Cell::interval(2.0, kNone).shown(column), "2");
  EXPECT_EQ(Cell().shown(column), "");
}

TEST(Table, HasAFieldOfEachRowInItsColumns) {
  const auto is_slow = [](const std::string& pass) { return pass == "filter"; };
  const std::vector<Field<std::string>> fields = {{{"pass"}, std::identity()}, {{"slow"}, is_slow}};
  const Table table = table_of<std::string>({}, std::vector<std::string>{"filter"}, fields);
  EXPECT_EQ(to_json(table), Json::parse(R"([{"pass": "filter", "slow": true}])"));
}

TEST(Measurements, StandInReportsAndTablesAsTheyAreDeclared) {
  static constexpr Measure kP95{"p95_mm", "P95", ""}, kPixels{"pixels", "pixels", ""};
  static constexpr const Measure* kShown[] = {&kP95, &kPixels};
  Measurements found;
  found.add(kP95, 1.25);
  found.add(kPixels, 12);
  found.prefix("back");
  found.add(kP95, 3.0);
  EXPECT_EQ(to_json(found), Json::parse(R"({"p95_mm": 1.25, "pixels": 12, "back_p95_mm": 3.0})"));
  const Table table{.columns = columns_of({}, kShown), .rows = {cells_of({}, found, kShown)}};
  EXPECT_EQ(markdown(table), "| P95, mm | pixels |\n| ---: | ---: |\n| 1.25 | 12 |\n");
}

TEST(Table, ColumnsAreChosenByTheirKeys) {
  const Table chosen = with_columns(passes(), {"n", "pass", "not there"});
  EXPECT_EQ(csv(chosen), "n,pass\n12,filter\n1000000,ray|casting\n");
}

TEST(Table, ZeroHasNoSign) {
  const Column column{"mm", "", "mm", 2};
  EXPECT_EQ(Cell(-0.001).shown(column), "0.00");
  EXPECT_EQ(Cell(-0.01).shown(column), "-0.01");
  EXPECT_EQ(Cell::interval(-0.001, 0.5).shown(column), "0.00 ± 0.50");
}

TEST(Table, ARowOfAnotherLengthIsAFault) {
  Table table = passes();
  EXPECT_THROW(table.add({"filter"}), std::logic_error);
}

TEST(Table, RowsWithoutAnIdKeepTheirPlaceBesideThoseWithOne) {
  Table table{.name = "t", .columns = {{"a"}}};
  table.add({1});
  table.add({2}, "point-2");
  table.add({3});
  EXPECT_EQ(table.ids, (std::vector<std::string>{"", "point-2", ""}));
}

/// Values of all layers with this mark.
Json values_of(const Json& specification, const std::string& mark) {
  Json values = Json::array();
  for (const Json& layer : specification.at("layer")) {
    if (layer.at("mark").at("type") != mark) continue;
    for (const Json& value : layer.at("data").at("values")) values.push_back(value);
  }
  return values;
}

TEST(Chart, LinesMarksAndIntervalsAreLayersOfTheSameValues) {
  Chart chart{"title", {"range (mm)"}, {"error (mm)", Scale::logarithmic}};
  chart.series.push_back({.name = "found",
                          .x = {1, 2, 3},
                          .y = {0.1, 0, 0.3},
                          .mark = Mark::disc,
                          .low = {0.05, 0, 0.2},
                          .high = {0.2, 1, 0.4},
                          .ids = {"a", "b", "c"}});
  const Json json = specification(chart);
  const Json marks = values_of(json, "point");
  ASSERT_EQ(marks.size(), 3U);
  EXPECT_EQ(marks[2]["y"], 0.3);
  EXPECT_EQ(marks[2]["id"], "c");
  EXPECT_TRUE(marks[1]["y"].is_null()) << "0 has no place on a logarithmic axis";
  EXPECT_EQ(values_of(json, "line").size(), 3U);
  EXPECT_EQ(values_of(json, "rule")[0]["high"], 0.2);
  EXPECT_EQ(json["layer"][0]["encoding"]["y"]["scale"]["type"], "log");
  EXPECT_EQ(json["layer"][0]["encoding"]["x"]["title"], "range (mm)");
}

TEST(Chart, SeriesWithoutANameOrWithTheSameOneStayApart) {
  Chart chart{"", {"x"}, {"y"}};
  for (const char* name : {"a", "", "a", ""}) chart.series.push_back({name, {1}, {2}});
  const Json colour = specification(chart)["layer"][0]["encoding"]["color"];
  EXPECT_EQ(colour["scale"]["domain"], (Json{"a", "(series 2)", "(series 3)", "(series 4)"}));
  EXPECT_EQ(colour["legend"]["values"], Json::array({"a"}));
}

TEST(Chart, WithoutAValueItSaysSo) {
  Chart chart{"title", {"x"}, {"y", Scale::logarithmic}};
  EXPECT_EQ(specification(chart)["mark"]["text"], "nothing to show");
  chart.series.push_back({"a", {1, kNone}, {-1, 1}});
  EXPECT_EQ(specification(chart)["mark"]["text"], "nothing to show");
  chart.series.push_back({"b", {1}, {1}});
  EXPECT_EQ(specification(chart)["layer"].size(), 1U);
}

TEST(Chart, NamesStandAtTheWholeNumbersOfAnAxis) {
  Chart chart{"", {.label = "setting", .names = {"fast", "plain"}}, {"ms"}};
  chart.series.push_back({.name = "a", .x = {0.1, 0.9}, .y = {1, 2}, .mark = Mark::disc});
  const Json json = specification(chart);
  EXPECT_EQ(values_of(json, "point")[1]["at"], "plain");
  const Json x = json["layer"][0]["encoding"]["x"];
  EXPECT_EQ(x["axis"]["labelExpr"], "[\"fast\",\"plain\"][datum.value]");
  EXPECT_EQ(x["axis"]["values"], (Json{0, 1}));
}

TEST(Chart, BarsAreStackedInTheOrderOfTheirParts) {
  const BarChart chart{"", "ms", {"fast", "plain"}, {{"pass 1", {1, 2}}, {"pass 2", {3, kNone}}}};
  const Json values = specification(chart)["data"]["values"];
  ASSERT_EQ(values.size(), 4U);
  EXPECT_EQ(values[1], (Json{{"row", "plain"}, {"part", "pass 1"}, {"i", 0}, {"value", 2.0}}));
  EXPECT_TRUE(values[3]["value"].is_null());
}

TEST(Chart, PanelsOfAFigureHaveSelectionsOfTheirOwn) {
  Chart chart{"", {"x"}, {"y"}};
  chart.series.push_back({"a", {1}, {1}});
  const Json json = specification(Figure{"both", "Two.", {chart, chart}});
  ASSERT_EQ(json["concat"].size(), 2U);
  const auto selection = [&](int panel) {
    return json["concat"][panel]["layer"][0]["params"][0]["name"];
  };
  EXPECT_NE(selection(0), selection(1));
}

TEST(Document, AsMarkdownLeavesOutWhatOnlyAPageShows) {
  Chart chart{"", {"x"}, {"y"}};
  Document document{.title = "Latency", .name = "latency"};
  document.add(Text{"Made by `wobblebench latency`.\n"})
      .add(Heading{"Stalls"})
      .add(Table{.name = "t", .caption = "Two columns.", .columns = {{"a"}, {"b"}}})
      .add(Figure{"stalls", "A chart.", {chart}})
      .add(Picture{"out.png", "A picture."})
      .add(Detail{.id = "point-1", .title = "hidden"})
      .add(Listing{"hidden", "hidden"})
      .add(CommandLine{"wobblebench latency"});
  EXPECT_EQ(markdown(document),
            "# Latency\n\n"
            "Made by `wobblebench latency`.\n\n"
            "## Stalls\n\n"
            "Two columns.\n\n| a | b |\n| ---: | ---: |\n\n"
            "[Chart: A chart.](latency_stalls.vl.json)\n\n"
            "![A picture.](out.png)\n\n"
            "    wobblebench latency\n");
}

}  // namespace
}  // namespace wobblebench::bench
