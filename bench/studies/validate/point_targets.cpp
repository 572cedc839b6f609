#include "bench/studies/validate/point_targets.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <memory>

#include "bench/studies/validate/bodies.h"
#include "bench/studies/validate/scan.h"
#include "bench/studies/validate/statistics.h"
#include "sim/beam/beam_profile.h"
#include "sim/beam/point_spread.h"
#include "sim/echo/reference_scene.h"
#include "sim/scatterers/scatterer_field.h"

namespace wobblebench::bench {

namespace {

/// Half length of a profile, in full widths at half maximum.
constexpr double kReachFwhm = 1.7;

/// A single scatterer, and a rung that computes its echo.
class PointTarget {
 public:
  PointTarget(sim::Rung rung, const hw::AcquisitionPlan& plan, double range_m, bool side_lobes)
      : plan_(plan), point_{{0, 0, plan.probe().radius_m + range_m}, 1} {
    auto options = lossless_envelope(rung, 1);
    options.side_lobes = side_lobes;
    const auto water = open_tissue("amniotic_fluid");
    const sim::ScannedTissue subject{
        std::make_shared<const sim::TissueMap>(water, 1e-3, options.threads),
        water.materials(),
        {},
        {}};
    if (rung == sim::Rung::reference) {
      const auto scene = std::make_shared<const sim::ReferenceScene>(subject, plan, options);
      add_ = [=](const auto& path, auto points, auto iq) { scene->add_points(path, points, iq); };
    } else {
      const auto field = std::make_shared<const sim::ScattererField>(subject, plan, options);
      add_ = [=](const auto& path, auto points, auto iq) { field->add_points(path, points, iq); };
    }
  }

  /// Envelope of a stick.
  std::vector<double> stick(double theta_rad, double phi_rad) const {
    const auto samples = static_cast<std::size_t>(plan_.acquisition().samples_per_stick);
    const std::vector<float> left(samples, 1.0f);
    std::vector<std::complex<float>> iq(samples);
    const sim::TimedRay line{plan_.geometry().stick(theta_rad, phi_rad), 0};
    add_({line, plan_.sample_spacing_m(), left, {}}, std::span(&point_, 1), iq);
    std::vector<double> envelope;
    for (const auto& value : iq) envelope.push_back(static_cast<double>(std::abs(value)));
    return envelope;
  }

 private:
  hw::AcquisitionPlan plan_;
  sim::PointEcho point_;
  std::function<void(
      const sim::StickPath&, std::span<const sim::PointEcho>, std::span<std::complex<float>>)>
      add_;
};

Profile make_profile(std::vector<double> offsets_m,
                     std::vector<double> amplitudes,
                     double formula_m) {
  const Peak peak = gaussian_peak(amplitudes);
  const double middle_m = offsets_m.front() + peak.position * (offsets_m[1] - offsets_m[0]);
  for (double& offset_m : offsets_m) offset_m -= middle_m;
  for (double& amplitude : amplitudes) amplitude /= peak.value;
  Profile profile{std::move(offsets_m), std::move(amplitudes), 0, formula_m};
  profile.fwhm_m = full_width_at_half(profile.offset_m, profile.amplitude);
  return profile;
}

Profile along(const hw::AcquisitionPlan& plan, const std::vector<double>& stick) {
  const double formula_m = sim::axial_fwhm_m(plan);
  const auto top = std::max_element(stick.begin(), stick.end()) - stick.begin();
  const auto reach = static_cast<std::ptrdiff_t>(kReachFwhm * formula_m / plan.sample_spacing_m());
  std::vector<double> offsets_m, amplitudes;
  for (auto k = top - reach; k <= top + reach; ++k) {
    offsets_m.push_back(plan.sample_range_m(static_cast<int>(k)));
    amplitudes.push_back(stick.at(static_cast<std::size_t>(k)));
  }
  return make_profile(std::move(offsets_m), std::move(amplitudes), formula_m);
}

}  // namespace

PointResult measure_point(sim::Rung rung,
                          double range_m,
                          bool side_lobes,
                          const PointInputs& inputs) {
  hw::ProbeOptions probe;
  if (inputs.in_focus) probe.transmit_focus_m = probe.elevation_focus_m = range_m;
  // Samples so fine that IQ samples need no oversampling.
  const hw::AcquisitionPlan plan(probe, {.depth_m = range_m + 10e-3, .samples_per_stick = 4096});
  const PointTarget point(rung, plan, range_m, side_lobes);
  const sim::BeamProfile profile(plan, {});
  const auto across = [&](bool in_plane, double radius_m, double formula_m) {
    std::vector<double> offsets_m, amplitudes;
    for (int i = 0; i < inputs.across; ++i) {
      const double offset_m = kReachFwhm * formula_m * (2.0 * i / (inputs.across - 1) - 1);
      const double angle = offset_m / radius_m;
      offsets_m.push_back(offset_m);
      amplitudes.push_back(
          gaussian_peak(in_plane ? point.stick(angle, 0) : point.stick(0, angle)).value);
    }
    return make_profile(std::move(offsets_m), std::move(amplitudes), formula_m);
  };
  const auto middle = point.stick(0, 0);
  const double to_center_m = plan.probe().radius_m + range_m;
  const double to_axis_m = to_center_m - plan.geometry().axis_z_m();
  return {range_m,
          gaussian_peak(middle).value,
          along(plan, middle),
          across(true, to_center_m, profile.lateral_fwhm_m(range_m)),
          across(false, to_axis_m, profile.elevation_fwhm_m(range_m))};
}

}  // namespace wobblebench::bench
