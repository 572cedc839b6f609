#include "bench/studies/validate/point_targets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/parallel.h"
#include "base/units.h"
#include "bench/studies/validate/point_echoes.h"
#include "bench/studies/validate/preset_plan.h"
#include "bench/studies/validate/statistics.h"
#include "sim/losses/losses.h"
#include "sim/optics/beam_profile.h"

namespace wobblebench::bench {

namespace {

constexpr double kDepth_m = 0.17;
constexpr int kSamples = 4096;  // IQ samples then need no oversampling
constexpr int kLines = 257;     // no sparser than the tables of beams ever are
constexpr int kBeyond = 32;     // lines: half the widest profile
/// Sticks of a profile, and how far it reaches at first, in expected widths.
constexpr int kAcross = 49;
constexpr double kReach = 1.0;
constexpr double kWider = 1.5;
constexpr int kTries = 4;

hw::AcquisitionPlan plan_of(hw::ProbePreset preset) {
  return preset_plan(preset,
                     {.depth_m = kDepth_m,
                      .sticks_per_frame = kLines,
                      .samples_per_stick = kSamples,
                      .frames_per_volume = 1},
                     kBeyond);
}

/// Full width at half of the largest of `value(offset_m)`, over a reach that grows until it holds
/// it.
template <class Value>
double width_m(double expected_m, const Value& value) {
  double reach_m = kReach * expected_m;
  for (int i = 0; i < kTries; ++i, reach_m *= kWider) {
    std::vector<double> offsets_m, values;
    for (int j = 0; j < kAcross; ++j) {
      offsets_m.push_back(reach_m * (2.0 * j / (kAcross - 1) - 1));
      values.push_back(value(offsets_m.back()));
    }
    const double half = 0.5 * *std::ranges::max_element(values);
    if (values.front() < half && values.back() < half) return full_width_at_half(offsets_m, values);
  }
  throw std::runtime_error("points: a profile does not fall to half on both sides");
}

class PointScan {
 public:
  PointScan(hw::ProbePreset preset, const PointRung& rung, double db_per_cm_mhz = 0)
      : plan_(plan_of(preset)),
        echoes_(rung.rung, plan_, rung.side_lobes, loss_of(db_per_cm_mhz)) {}

  BeamRow measure(const BeamRow& place) const {
    const hw::ProbeGeometry geometry = plan_.geometry();
    const sim::PointEcho point{geometry.to_cartesian({place.range_m, place.theta_rad, 0}), 1};
    const auto stick = [&](double turn_rad, double phi_rad) {
      return echoes_.envelope(place.theta_rad + turn_rad, phi_rad, {&point, 1});
    };
    const auto peak = [&](double turn_rad, double phi_rad) {
      return gaussian_peak(stick(turn_rad, phi_rad)).value;
    };
    const double radius_m = geometry.radius_m() + place.range_m;
    const double lever_m = radius_m * std::cos(place.theta_rad) - geometry.axis_z_m();
    const auto across_lines = [&](double offset_m) { return peak(offset_m / radius_m, 0); };
    const auto across_frames = [&](double offset_m) { return peak(0, offset_m / lever_m); };
    BeamRow found = place;
    found.lateral_m = width_m(place.lateral_m, across_lines);
    found.elevation_m = width_m(place.elevation_m, across_frames);
    found.axial_m = full_width_at_half(sample_ranges_m(), stick(0, 0));
    found.level_db = 20 * std::log10(peak(0, 0));
    return found;
  }

 private:
  std::vector<double> sample_ranges_m() const {
    std::vector<double> ranges_m;
    for (int k = 0; k < kSamples; ++k) ranges_m.push_back(plan_.sample_range_m(k));
    return ranges_m;
  }

  WayLoss loss_of(double db_per_cm_mhz) const {
    WayLoss loss;
    if (db_per_cm_mhz == 0) return loss;
    const sim::BandLoss band(plan_.probe());
    for (const double range_m : sample_ranges_m()) {
      const double nepers = 2 * db_per_cm_mhz * plan_.probe().center_frequency_hz / kMegahertz *
                            range_m * 1e2 * std::log(10.0) / 20;
      loss.remaining.push_back(static_cast<float>(std::exp(band.log_gain(nepers) - nepers)));
      loss.frequency_ratio.push_back(static_cast<float>(band.frequency_ratio(nepers)));
    }
    return loss;
  }

  hw::AcquisitionPlan plan_;
  PointEchoes echoes_;
};

std::vector<BeamComparison> field_widths(hw::ProbePreset preset, std::span<const BeamRow> places) {
  const hw::AcquisitionPlan plan = plan_of(preset);
  const std::vector<BeamRow> own = stick_beam_rows(preset);
  const sim::BeamProfile profile{sim::ProbeOptics(plan)};
  std::vector<BeamComparison> results;
  for (BeamRow place : places) {
    const auto same = std::ranges::find_if(own, [&](const BeamRow& row) {
      return row.sector_fraction == place.sector_fraction && row.range_m == place.range_m;
    });
    if (same == own.end()) throw std::invalid_argument("stick_beam.csv lacks a place");
    place.lateral_m = same->lateral_m;
    BeamRow found = place;
    found.lateral_m = profile.lateral_fwhm_m(place.range_m, place.theta_rad);
    found.elevation_m = profile.elevation_fwhm_m(place.range_m);
    found.axial_m = found.level_db = std::numeric_limits<double>::quiet_NaN();
    results.push_back({place, found});
  }
  return results;
}

}  // namespace

std::vector<BeamComparison> measure_points(hw::ProbePreset preset,
                                           const PointRung& rung,
                                           std::span<const BeamRow> places) {
  if (rung.rung == sim::Rung::field) return field_widths(preset, places);
  const PointScan scan(preset, rung);
  std::vector<BeamComparison> results(places.size());
  parallel_rows(static_cast<int>(places.size()), [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    results[at] = {places[at], scan.measure(places[at])};
  });
  return results;
}

std::vector<BeamComparison> measure_attenuated_points(double db_per_cm_mhz,
                                                      std::span<const BeamRow> places) {
  const PointScan scan(hw::ProbePreset::standard, {sim::Rung::scatterers, false}, db_per_cm_mhz);
  std::vector<BeamComparison> results(places.size());
  parallel_rows(static_cast<int>(places.size()), [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    results[at] = {places[at], scan.measure(places[at])};
  });
  return results;
}

}  // namespace wobblebench::bench
