#include <cmath>

#include "base/number_text.h"
#include "bench/studies/validate/study_reports.h"
#include "bench/studies/validate/table_comparison.h"

namespace wobblebench::bench {

namespace {

constexpr double kFrom_m = 30e-3, kTo_m = 160e-3;
constexpr double kAlphas[] = {0.3, 0.5, 1.0};  // dB/cm/MHz one way
constexpr double kMostChecked = 0.5;           // soft tissue's
constexpr double kWidthBar = 10;               // percent
constexpr double kLevelBar_db = 1;
/// Behind the plane losses are tabulated each 8 mm: nearer edges are not checked.
constexpr double kBehind_m = 80e-3;
constexpr double kRiseBar = 20;  // percent
/// Levels compared: where the plane takes something, and the echo is not yet that through it.
constexpr double kLit_db = -0.1, kDark_db = -25;
constexpr double kEdgeBar_db = 2;

void add_attenuation(StudyReport& report) {
  for (const double alpha : kAlphas) {
    const auto found = measure_attenuated_points(alpha, attenuated_rows(alpha));
    const auto here = at_places(found, StickPlaces::axis, kFrom_m, kTo_m);
    const std::string name = "losses.attenuated." + significant(alpha, 2);
    add_points("attenuated " + significant(alpha, 2), found, report);
    if (alpha > kMostChecked) continue;
    for (const BeamWidth& width : {kLateral, kElevation, kAxial}) {
      report.checks.push_back(worst_width(name + "." + width.name, here, width, kWidthBar));
    }
    report.checks.push_back(worst_level(name + ".level", here, kLevelBar_db));
  }
}

/// Mean distance between rung and table, dB.
double mean_distance_db(const ShadowEdge& edge) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < edge.level_db.size(); ++i) {
    if (edge.expected_db[i] > kLit_db || edge.expected_db[i] < kDark_db) continue;
    sum += std::abs(edge.level_db[i] - edge.expected_db[i]);
    ++count;
  }
  return sum / count;
}

Check worst_edge_level(const std::string& name,
                       const std::vector<ShadowEdge>& edges,
                       bool across_lines) {
  Check check{name, Check::Kind::at_most, 0, kEdgeBar_db, 0, "dB", "", 0, "ranges", {}};
  for (const ShadowEdge& edge : edges) {
    if (edge.across_lines != across_lines || edge.range_m < kBehind_m) continue;
    const double distance_db = mean_distance_db(edge);
    ++check.n;
    if (!check.source.empty() && distance_db <= check.measured) continue;
    check.measured = distance_db;
    check.source =
        "mean distance from the table, worst at " + significant(edge.range_m * 1e3, 3) + " mm";
  }
  return check;
}

Check worst_rise(const std::string& name, const std::vector<ShadowEdge>& edges, bool across_lines) {
  Check check{name, Check::Kind::at_most, 0, kRiseBar, 0, "%", "", 0, "ranges", {}};
  for (const ShadowEdge& edge : edges) {
    if (edge.across_lines != across_lines || edge.range_m < kBehind_m) continue;
    const double error = 100 * std::abs(edge.rise_m / edge.expected_rise_m - 1);
    ++check.n;
    if (!check.source.empty() && error <= check.measured) continue;
    check.measured = error;
    check.source = "worst at " + significant(edge.range_m * 1e3, 3) +
                   " mm: " + significant(edge.rise_m * 1e3, 3) + " mm, table " +
                   significant(edge.expected_rise_m * 1e3, 3) + " mm";
  }
  return check;
}

void add_shadow(StudyReport& report) {
  const auto edges = measure_shadow_edges();
  for (const bool across_lines : {true, false}) {
    const std::string name = across_lines ? "losses.shadow.lateral" : "losses.shadow.elevation";
    report.checks.push_back(worst_rise(name + ".rise", edges, across_lines));
    report.checks.push_back(worst_edge_level(name + ".level", edges, across_lines));
  }
  for (const ShadowEdge& edge : edges) {
    const std::string across = edge.across_lines ? "lateral" : "elevation";
    const std::string name = "shadow " + across + " " + significant(edge.range_m * 1e3, 3) + " mm";
    for (std::size_t i = 0; i < edge.crossing_m.size(); ++i) {
      report.points.push_back({name,
                               "crossing_mm",
                               edge.crossing_m[i] * 1e3,
                               "level_db",
                               edge.level_db[i],
                               edge.expected_db[i]});
    }
  }
}

/// The edges of one direction: table and rung over where the axis crosses the plane.
Picture3 draw_edges(const std::string& title, bool across_lines, const StudyReport& report) {
  Chart chart{title, {"axis beside the edge (mm)"}, {"level (dB re no plane)"}};
  const std::string prefix = across_lines ? "shadow lateral " : "shadow elevation ";
  for (const DataPoint& point : report.points) {
    if (!point.series.starts_with(prefix)) continue;
    const std::string range = point.series.substr(prefix.size());
    if (chart.series.empty() || chart.series.back().name != "field, " + range) {
      const int colour = static_cast<int>(chart.series.size() / 2);
      chart.series.push_back({"table, " + range, {}, {}, Stroke::solid, Mark::none, colour});
      chart.series.push_back({"field, " + range, {}, {}, Stroke::none, Mark::square, colour});
    }
    Series &table = chart.series[chart.series.size() - 2], &rung = chart.series.back();
    table.x.push_back(point.x);
    table.y.push_back(*point.expected);
    rung.x.push_back(point.x);
    rung.y.push_back(point.y);
  }
  return draw(chart, {620, 460});
}

constexpr char kText[] =
    "Attenuated: a point on the middle stick, rung `scatterers`, all tissue attenuating by 0.3 and "
    "0.5 dB/cm/MHz (1 in the CSV file alone), against `attenuation.csv`, which attenuates each "
    "frequency by itself, as the simulator does at the eight frequencies of its beam "
    "(decision 27). "
    "Both end at a fifth of the frequency sent. At 30 mm the lateral profile has shoulders of half "
    "its height, whose width changes by a quarter from 0 to 0.5 dB/cm/MHz.\n\n"
    "Shadow: even tissue behind a plane at 60 mm that passes a tenth of the amplitude each way and "
    "ends beside the stick, rung `field` without speckle, against `shadow.csv`; rise is from 10 to "
    "90 % of the amplitude, level is from 0.1 to 25 dB below no plane; both are checked from 20 mm "
    "behind the plane on. At 130 mm the rise begins on a shoulder 0.9 dB below the top, so that "
    "0.1 dB there are 1 mm. Nearer than 8 mm behind the plane the simulator's edge is as sharp as "
    "a "
    "stick (decision 26).";

}  // namespace

StudyReport losses_report() {
  StudyReport report;
  report.id = "losses";
  report.title = "Losses over the band and over the aperture";
  add_attenuation(report);
  add_shadow(report);
  report.figures.push_back({"losses_shadow",
                            "Behind a half plane that lies at positive places, across lines and "
                            "across frames. Lines: shadow.csv.",
                            side_by_side({draw_edges("Across lines", true, report),
                                          draw_edges("Across frames", false, report)})});
  report.text = kText;
  return report;
}

}  // namespace wobblebench::bench
