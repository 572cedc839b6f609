#include "bench/studies/validate/losses/losses.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/number_text.h"
#include "base/units.h"
#include "bench/studies/validate/common/scan.h"
#include "bench/studies/validate/common/study_report.h"
#include "bench/studies/validate/points/point_targets.h"
#include "phantoms/grids.h"
#include "phantoms/shapes/level_set.h"
#include "phantoms/shapes/shapes.h"

namespace wobblebench::bench {

namespace {

constexpr double kPlane_m = 60e-3;  // from the face
constexpr double kTransparency = 0.1;
constexpr double kThickness_m = 1e-3;
constexpr double kLength_m = 80e-3;  // beyond the edge, and half of it to either side
constexpr double kVoxel_m = 0.5e-3;
constexpr int kAcross = 120;  // even: the edge lies midway between two sticks

/// A sheet whose edge is the phantom's origin: it lies at positive x, or y.
phantoms::Phantom sheet(bool across_lines) {
  const glm::dvec3 half(0.5 * kLength_m, 0.5 * kLength_m, 0.5 * kThickness_m);
  const glm::dvec3 center(across_lines ? half.x : 0, across_lines ? 0 : half.y, 0.5 * kThickness_m);
  const double room = kLength_m + 8 * kVoxel_m;
  auto grids = std::make_shared<phantoms::Grids>();
  grids->signed_distance = {phantoms::build_level_set(
      "sheet",
      [=](const glm::dvec3& p) { return phantoms::box_distance(p - center, half); },
      {glm::dvec3(-room, -room, -6 * kVoxel_m),
       glm::dvec3(room, room, kThickness_m + 6 * kVoxel_m)},
      kVoxel_m,
      phantoms::Distances::exact)};
  // Both faces together pass the transparency twice, at any angle: the sound speed is the tissue's.
  auto materials = phantoms::material_table();
  const auto& tissue = phantoms::material("soft_tissue");
  const double reflection = std::sqrt(1 - kTransparency);
  auto& matter = materials[static_cast<std::size_t>(phantoms::material_index("cortical_bone"))];
  matter.sound_speed_m_s = tissue.sound_speed_m_s;
  matter.attenuation_db_per_cm_mhz = tissue.attenuation_db_per_cm_mhz;
  matter.impedance_rayl = tissue.impedance_rayl * (1 + reflection) / (1 - reflection);
  return {"sheet",
          materials,
          phantoms::material_index("soft_tissue"),
          {{"sheet", phantoms::material_index("cortical_bone"), true}},
          {glm::dvec3(-room), glm::dvec3(room)},
          glm::dvec3(0),
          grids};
}

hw::AcquisitionPlan plan_across(bool across_lines) {
  hw::AcquisitionOptions options{.depth_m = 0.135, .samples_per_stick = 864};
  options.sticks_per_frame = across_lines ? kAcross : 9;
  options.frames_per_volume = across_lines ? 9 : kAcross;
  options.sector_rad = (across_lines ? 30 : 6) * kDegree;
  options.fan_rad = (across_lines ? 4 : 34) * kDegree;
  return {{}, options};
}

/// Mean echo without speckle: the rung's own mean power.
Scan scan_tissue(const phantoms::Phantom& phantom, const hw::AcquisitionPlan& plan) {
  auto options = bare_envelope(sim::Rung::field, 1);
  options.speckle = false;
  options.interface_echo = false;
  options.attenuation = false;
  const glm::dvec3 edge(0, 0, plan.probe().radius_m + kPlane_m);
  return scan(phantoms::still_at(phantom, edge), plan, options);
}

/// Level of the sticks of the middle frame, or line, and where their axes meet the plane.
struct Sticks {
  std::vector<double> crossing_m;
  std::vector<double> level_db;
};

Sticks levels_at(const Scan& with, const Scan& without, bool across_lines, double range_m) {
  const auto& plan = with.plan;
  const int sample = with.sample_at(range_m);
  const double plane_z = plan.probe().radius_m + kPlane_m;
  Sticks sticks;
  for (int i = 0; i < kAcross; ++i) {
    const int line = across_lines ? i : plan.acquisition().sticks_per_frame / 2;
    const int frame = across_lines ? plan.acquisition().frames_per_volume / 2 : i;
    const auto ray = plan.geometry().stick(plan.theta_rad(line), plan.frame_phi_rad(frame));
    const glm::dvec3 at = ray.at((plane_z - ray.origin.z) / ray.direction.z);
    sticks.crossing_m.push_back(across_lines ? at.x : at.y);
    sticks.level_db.push_back(
        20 * std::log10(with.at(frame, line, sample) / without.at(frame, line, sample)));
  }
  if (sticks.crossing_m.front() > sticks.crossing_m.back()) {
    std::ranges::reverse(sticks.crossing_m);
    std::ranges::reverse(sticks.level_db);
  }
  return sticks;
}

/// Linear between sticks.
double level_at(const Sticks& sticks, double crossing_m) {
  const auto& x = sticks.crossing_m;
  if (crossing_m < x.front() || crossing_m > x.back()) {
    throw std::out_of_range("losses: no stick crosses the plane there");
  }
  const auto behind =
      std::max<std::ptrdiff_t>(1, std::ranges::lower_bound(x, crossing_m) - x.begin());
  const auto to = static_cast<std::size_t>(behind), from = to - 1;
  return std::lerp(
      sticks.level_db[from], sticks.level_db[to], (crossing_m - x[from]) / (x[to] - x[from]));
}

void measure(bool across_lines, std::vector<ShadowEdge>& edges) {
  const hw::AcquisitionPlan plan = plan_across(across_lines);
  const Scan with = scan_tissue(sheet(across_lines), plan);
  const Scan without = scan_tissue(open_tissue(), plan);
  for (ShadowEdge& edge : edges) {
    if (edge.across_lines != across_lines) continue;
    const Sticks sticks = levels_at(with, without, across_lines, edge.range_m);
    for (const double crossing_m : edge.crossing_m) {
      edge.level_db.push_back(level_at(sticks, crossing_m));
    }
    edge.rise_m = rise_m(edge.crossing_m, edge.level_db);
  }
}

}  // namespace

double rise_m(const std::vector<double>& crossing_m, const std::vector<double>& level_db) {
  const auto amplitude = [&](std::size_t i) { return std::pow(10, level_db[i] / 20); };
  const std::size_t last = crossing_m.size() - 1;
  const double dark = amplitude(last), step = amplitude(0) - dark;
  const auto place_of = [&](double share) {
    std::size_t i = last;
    while (i > 0 && amplitude(i - 1) < dark + share * step) --i;
    const double from = amplitude(i), to = amplitude(i - 1);
    return std::lerp(crossing_m[i], crossing_m[i - 1], (dark + share * step - from) / (to - from));
  };
  return std::abs(place_of(0.9) - place_of(0.1));
}

std::vector<ShadowEdge> measure_shadow_edges() {
  std::vector<ShadowEdge> edges;
  for (const ShadowRow& row : shadow_rows()) {
    if (edges.empty() || edges.back().range_m != row.range_m ||
        edges.back().across_lines != row.across_lines) {
      edges.push_back({row.across_lines, row.range_m, 0, row.rise_m, {}, {}, {}});
    }
    edges.back().crossing_m.push_back(row.crossing_m);
    edges.back().expected_db.push_back(row.level_db);
  }
  measure(true, edges);
  measure(false, edges);
  return edges;
}

namespace {

constexpr double kFrom_m = 30e-3, kTo_m = 160e-3;
constexpr double kAlphas[] = {0.3, 0.5, 1.0};  // dB/cm/MHz one way
constexpr double kMostChecked = 0.5;           // soft tissue's
constexpr double kWidthBar = 10;               // percent
constexpr double kLevelBar_db = 1;
/// Behind the plane losses are tabulated each 8 mm: edges nearer than 15 mm are not checked.
constexpr double kBehind_m = 74e-3;
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

double rise_error_percent(const ShadowEdge& edge) {
  return 100 * std::abs(edge.rise_m / edge.expected_rise_m - 1);
}

std::string mm_text(double metres) {
  return significant(metres * 1e3, 3) + " mm";
}

/// The worst rise and the worst level of one direction.
void add_shadow_checks(const std::string& name,
                       const std::vector<ShadowEdge>& edges,
                       bool across_lines,
                       StudyReport& report) {
  std::vector<ShadowEdge> here;
  std::ranges::copy_if(edges, std::back_inserter(here), [&](const ShadowEdge& edge) {
    return edge.across_lines == across_lines && edge.range_m >= kBehind_m;
  });
  const auto n = static_cast<long>(here.size());
  const ShadowEdge& rise = *std::ranges::max_element(here, {}, rise_error_percent);
  report.check(name + ".rise")
      .at_most(rise_error_percent(rise), kRiseBar, "%")
      .from("worst at " + mm_text(rise.range_m) + ": " + mm_text(rise.rise_m) + ", table " +
            mm_text(rise.expected_rise_m))
      .over(n, "ranges");
  const ShadowEdge& level = *std::ranges::max_element(here, {}, mean_distance_db);
  report.check(name + ".level")
      .at_most(mean_distance_db(level), kEdgeBar_db, "dB")
      .from("mean distance from the table, worst at " + mm_text(level.range_m))
      .over(n, "ranges");
}

void add_shadow(StudyReport& report) {
  const auto edges = measure_shadow_edges();
  add_shadow_checks("losses.shadow.lateral", edges, true, report);
  add_shadow_checks("losses.shadow.elevation", edges, false, report);
  for (const ShadowEdge& edge : edges) {
    const std::string across = edge.across_lines ? "lateral" : "elevation";
    const std::string name = "shadow " + across + " " + mm_text(edge.range_m);
    for (std::size_t i = 0; i < edge.crossing_m.size(); ++i) {
      report.point(name,
                   {"crossing_mm", edge.crossing_m[i] * 1e3},
                   {"level_db", edge.level_db[i], edge.expected_db[i]});
    }
  }
}

/// The edges of one direction: table and rung over where the axis crosses the plane.
Chart edge_chart(const std::string& title, bool across_lines, const StudyReport& report) {
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
    table.add(point.x, *point.expected);
    rung.add(point.x, point.y);
  }
  return chart;
}

constexpr char kText[] =
    "Attenuated: a point on the middle stick, rung `scatterers`, all tissue attenuating by 0.3 and "
    "0.5 dB/cm/MHz (1 in the CSV file alone), against `attenuation.csv`, which attenuates each "
    "frequency by itself, as the simulator does at the eight frequencies of its beam (decision "
    "27). Both end at a fifth of the frequency sent. At 30 mm the lateral profile has shoulders of "
    "half its height, whose width changes by a quarter from 0 to 0.5 dB/cm/MHz.\n\n"
    "Shadow: uniform tissue behind a plane at 60 mm that passes a tenth of the amplitude each way "
    "and ends beside the stick, rung `field` without speckle, against `shadow.csv`; rise is from "
    "10 to 90 % of the amplitude, level is from 0.1 to 25 dB below no plane; both are checked from "
    "15 mm behind the plane on. At 130 mm the rise begins on a shoulder 0.9 dB below the top, so "
    "that 0.1 dB there are 1 mm. Nearer than 8 mm the simulator has the "
    "edge of 8 mm behind the plane (decision 26).";

}  // namespace

StudyReport losses_report() {
  StudyReport report;
  add_attenuation(report);
  add_shadow(report);
  report.figures.push_back(
      {"losses_shadow",
       "Behind a half plane at positive coordinates, across lines and across "
       "frames. Lines: shadow.csv.",
       {edge_chart("Across lines", true, report), edge_chart("Across frames", false, report)}});
  report.text = kText;
  return report;
}

}  // namespace wobblebench::bench
