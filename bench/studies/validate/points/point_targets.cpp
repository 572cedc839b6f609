#include "bench/studies/validate/points/point_targets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

#include "base/parallel.h"
#include "base/units.h"
#include "bench/studies/validate/common/scan.h"
#include "bench/studies/validate/common/statistics.h"
#include "bench/studies/validate/common/study_report.h"
#include "sim/losses/losses.h"
#include "sim/optics/beam_profile.h"
#include "sim/optics/probe_optics.h"
#include "sim/rungs/reference_model.h"
#include "sim/speckle/scatterers/scatterer_field.h"

namespace wobblebench::bench {

PointEchoes::PointEchoes(sim::Rung rung,
                         const hw::AcquisitionPlan& plan,
                         bool side_lobes,
                         PathLoss loss)
    : plan_(plan), loss_(std::move(loss)) {
  if (sim::iq_oversampling(plan) != 1) throw std::invalid_argument("PointEchoes: coarse samples");
  auto options = lossless_envelope(rung, 1);
  options.side_lobes = side_lobes;
  const auto subject = scanned(open_tissue("amniotic_fluid"), options.threads);
  const sim::ProbeOptics optics(plan, options);
  if (rung == sim::Rung::reference) {
    const auto scene = std::make_shared<const sim::ReferenceScene>(subject, optics, options);
    add_ = [=](const auto& path, auto points, auto iq) { scene->add_points(path, points, iq); };
  } else {
    const auto settings =
        sim::ScattererSettings::of(options, {plan.sample_spacing_m(), loss_.frequency_ratio});
    const auto field =
        std::make_shared<const sim::ScattererField>(subject, optics, options, settings);
    add_ = [=](const auto& path, auto points, auto iq) { field->add_points(path, points, iq); };
  }
}

std::vector<double> PointEchoes::envelope(double theta_rad,
                                          double phi_rad,
                                          std::span<const sim::PointEcho> points) const {
  const auto samples = static_cast<std::size_t>(plan_.acquisition().samples_per_stick);
  const std::vector<float> left =
      loss_.remaining.empty() ? std::vector<float>(samples, 1.0f) : loss_.remaining;
  std::vector<std::complex<float>> iq(samples);
  const sim::TimedRay line{plan_.geometry().stick(theta_rad, phi_rad), 0};
  add_({line, plan_.sample_spacing_m(), left, {}, loss_.frequency_ratio}, points, iq);
  std::vector<double> envelope;
  for (const auto& value : iq) envelope.push_back(static_cast<double>(std::abs(value)));
  return envelope;
}

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

  std::vector<BeamComparison> compare(std::span<const BeamRow> places) const {
    std::vector<BeamComparison> results(places.size());
    parallel_rows(static_cast<int>(places.size()), [&](int i) {
      const auto at = static_cast<std::size_t>(i);
      results[at] = {places[at], measure(places[at])};
    });
    return results;
  }

 private:
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

  std::vector<double> sample_ranges_m() const {
    std::vector<double> ranges_m;
    for (int k = 0; k < kSamples; ++k) ranges_m.push_back(plan_.sample_range_m(k));
    return ranges_m;
  }

  PathLoss loss_of(double db_per_cm_mhz) const {
    PathLoss loss;
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
  return PointScan(preset, rung).compare(places);
}

std::vector<BeamComparison> measure_attenuated_points(double db_per_cm_mhz,
                                                      std::span<const BeamRow> places) {
  return PointScan(hw::ProbePreset::standard, {sim::Rung::scatterers, false}, db_per_cm_mhz)
      .compare(places);
}

namespace {

constexpr double kFrom_m = 30e-3, kTo_m = 160e-3;
constexpr double kAxisBar = 5, kEdgeBar = 10;  // percent
constexpr double kLevelBar_db = 0.5;

struct Variant {
  const char* name;
  PointRung rung;
  Mark mark;
};
constexpr Variant kVariants[] = {
    {"scatterers", {sim::Rung::scatterers, false}, Mark::disc},
    {"scatterers_side_lobes", {sim::Rung::scatterers, true}, Mark::triangle},
    {"reference", {sim::Rung::reference, false}, Mark::ring},
    {"field", {sim::Rung::field, false}, Mark::square}};

void add_checks(const std::string& name,
                const Variant& variant,
                std::span<const BeamComparison> found,
                StudyReport& report) {
  for (const StickPlaces places : {StickPlaces::axis, StickPlaces::edge}) {
    const bool axis = places == StickPlaces::axis;
    const auto here = at_places(found, places, kFrom_m, kTo_m);
    const std::string where = axis ? ".axis" : ".edge";
    const bool field = variant.rung.rung == sim::Rung::field;
    for (const BeamWidth& width : {kLateral, kElevation, kAxial}) {
      if (field && width.value == kAxial.value) continue;
      report.checks.push_back(
          worst_width(name + "." + width.name + where, here, width, axis ? kAxisBar : kEdgeBar));
    }
    if (field) continue;
    report.checks.push_back(worst_level(name + ".level" + where, here, kLevelBar_db));
  }
}

constexpr char kText[] =
    "One point on the axis of a stick, received by sticks that turn past it in the image plane and "
    "by frames that turn past it about the motor's axis, at every depth, angle and preset of "
    "`tests/yardstick/point_widths.csv`. Widths are those at half amplitude (-6 dB), between the "
    "first crossings on either side of the maximum. `scatterers` (main lobe, and with side lobes) "
    "and `reference` receive the point by their own sums of echoes; `field` has no points: shown "
    "are the widths by which it blurs the edges of tissue, across lines against `stick_beam.csv`: "
    "the beam of one stick blurs them, and towards the array's end, where each stick has another "
    "aperture, it is narrower than the profile of sticks that turn past a point. A level is that "
    "of the stick through the point over the middle stick's at the same range, since both rungs "
    "are normalised to the middle stick at every range; how the level falls with range there is "
    "left out of both. A few sticks beyond the sector's edge are scanned where a profile needs "
    "them; the array ends where it does. Checks name the worst of the depths from 30 mm on: "
    "`axis`, the middle stick; `edge`, all others up to the last one.";

}  // namespace

StudyReport point_target_report() {
  StudyReport report;
  for (const hw::ProbePreset preset : kPresets) {
    const std::string preset_name(table_name(preset));
    const auto places = point_width_rows(preset);
    std::vector<ChartedRung> rungs;
    for (const Variant& variant : kVariants) {
      const auto found = measure_points(preset, variant.rung, places);
      add_checks("points." + std::string(variant.name) + "." + preset_name, variant, found, report);
      add_points(std::string(variant.name) + " " + preset_name, found, report);
      rungs.push_back({variant.name, variant.mark, found});
    }
    report.figures.push_back(widths_figure("points", "one point's echo", preset, rungs));
  }
  report.text = kText;
  return report;
}

}  // namespace wobblebench::bench
