#include "bench/studies/validate/losses.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/units.h"
#include "bench/studies/validate/bodies.h"
#include "bench/studies/validate/scan.h"
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

}  // namespace wobblebench::bench
