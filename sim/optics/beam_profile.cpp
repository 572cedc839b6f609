#include "sim/optics/beam_profile.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/units.h"
#include "sim/optics/beam_row.h"
#include "sim/optics/point_spread.h"

namespace wobblebench::sim {

namespace {

constexpr double kRangeStep_m = 2.5e-3;
constexpr double kAngleStep_rad = 1.1 * kDegree;
/// Where half of the aperture is missing lobes are twice as wide, and lie on one side.
constexpr double kMissing = 3;
constexpr int kMinRanges = 8, kMaxRanges = 64;
constexpr int kColumns = 40;  ///< a side

/// Half of the widest beam that is looked at: two lobes, and half the aperture's shadow.
double window_m(double lobe_m, double aperture_m, double range_m, double focus_m) {
  return 2 * lobe_m + 0.6 * aperture_m * std::abs(1 - range_m / focus_m);
}

/// Height of the parabola through the largest sample and its neighbours.
double peak_height(const std::vector<double>& profile, std::ptrdiff_t at) {
  const auto last = static_cast<std::ptrdiff_t>(profile.size()) - 1;
  if (at == 0 || at == last) return profile[static_cast<std::size_t>(at)];
  const double *here = profile.data() + at, slope = 0.5 * (here[1] - here[-1]);
  const double curvature = here[1] - 2 * here[0] + here[-1];
  return curvature < 0 ? here[0] - 0.5 * slope * slope / curvature : here[0];
}

/// Between the first places on either side of the peak at which the profile is half of it.
double width_at_half(const std::vector<double>& profile, double step_m) {
  const auto peak = std::max_element(profile.begin(), profile.end());
  const double half = 0.5 * peak_height(profile, peak - profile.begin());
  double width = 0;
  for (const int side : {-1, 1}) {
    auto at = peak;
    const auto end = side < 0 ? profile.begin() : profile.end() - 1;
    while (at != end && at[side] >= half) at += side;
    width += static_cast<double>(std::abs(at - peak));
    if (at != end) width += (*at - half) / (*at - at[side]);
  }
  return width * step_m;
}

/// Integral over a row of the power at a node.
double power_m(const SampledRow& row, std::size_t node) {
  double sum = 0;
  for (const auto& value : row.values) sum += std::norm(value[node]);
  return row.step_m() * sum;
}

/// Peaks of the echoes along a row, given the response of the other direction on the axis.
std::vector<double> peaks(const SampledRow& row,
                          const PulseBand::Values& other,
                          const PulseBand& band) {
  std::vector<double> result;
  for (PulseBand::Values value : row.values) {
    for (std::size_t i = 0; i < value.size(); ++i) value[i] *= other[i];
    result.push_back(band.peak(value));
  }
  return result;
}

PulseBand::Values on_axis(const PlaneResponse& response, double range_m) {
  const PlanePoint axis{range_m, 0};
  return response.at({&axis, 1}).front();
}

}  // namespace

BeamGrid::BeamGrid(const hw::AcquisitionPlan& plan, double range_step_m, double angle_step_rad) {
  const double depth_m = plan.acquisition().depth_m;
  ranges_ = std::clamp(static_cast<int>(std::ceil(depth_m / range_step_m)), kMinRanges, kMaxRanges);
  range_step_m_ = depth_m / ranges_;
  const int last = plan.acquisition().sticks_per_frame - 1;
  const double farthest = std::max(std::abs(plan.theta_rad(0)), std::abs(plan.theta_rad(last)));
  angles_ = 1 + static_cast<int>(std::ceil(farthest / angle_step_rad));
  angle_step_rad_ = angles_ > 1 ? farthest / (angles_ - 1) : 1;
}

BeamGrid::Between BeamGrid::range_at(double range_m) const {
  const double at = std::clamp(range_m / range_step_m_ - 0.5, 0.0, ranges_ - 1.0);
  const auto first = static_cast<std::size_t>(at);
  return {first,
          std::min(first + 1, static_cast<std::size_t>(ranges_ - 1)),
          at - static_cast<double>(first)};
}

BeamGrid::Between BeamGrid::angle_at(double theta_rad) const {
  const double at = std::min(std::abs(theta_rad) / angle_step_rad_, angles_ - 1.0);
  const auto first = static_cast<std::size_t>(at);
  return {first,
          std::min(first + 1, static_cast<std::size_t>(angles_ - 1)),
          at - static_cast<double>(first)};
}

BeamProfile::BeamProfile(const hw::AcquisitionPlan& plan, const SimulationOptions& options)
    : plan_(plan),
      apodisation_(options.apodisation),
      band_(plan),
      grid_(plan, kRangeStep_m, kAngleStep_rad),
      axial_fwhm_m_(sim::axial_fwhm_m(plan)) {
  entries_.resize(static_cast<std::size_t>(grid_.ranges() * grid_.angles()));
  parallel_ranges(grid_.ranges(), options.threads, [&](int first, int last) {
    for (int range = first; range < last; ++range) measure(range);
  });
}

void BeamProfile::measure(int range) {
  const double range_m = grid_.range_m(range);
  const auto& probe = plan_.probe();
  const double height_m = probe.element_height_m;
  const PlaneResponse elevation = PlaneResponse::elevation(
      ElevationSources(plan_),
      band_,
      InPlaneExcess(StickAperture(plan_, apodisation_, 0), plan_, band_, range_m));
  const SampledRow across = sample_row(
      elevation,
      range_m,
      window_m(
          wavelength_m(plan_) * range_m / height_m, height_m, range_m, probe.elevation_focus_m),
      true,
      kColumns);
  const PulseBand::Values elevation_axis = on_axis(elevation, range_m);
  const double lateral_window_m =
      window_m(kMissing * wavelength_m(plan_) * range_m / receive_aperture_m(plan_, range_m),
               transmit_aperture_m(plan_, range_m),
               range_m,
               transmit_focus_m(plan_, range_m));
  for (int angle = 0; angle < grid_.angles(); ++angle) {
    const StickAperture aperture(plan_, apodisation_, grid_.angle_rad(angle));
    Entry& entry = entries_[static_cast<std::size_t>(range * grid_.angles() + angle)];
    if (angle > 0 && aperture.whole(range_m)) {  // the middle stick's beam
      entry = entries_[static_cast<std::size_t>(range * grid_.angles())];
      continue;
    }
    const PlaneResponse lateral = PlaneResponse::lateral(aperture, plan_, band_, range_m);
    const SampledRow along = sample_row(lateral, range_m, lateral_window_m, true, kColumns);
    entry = {width_at_half(peaks(along, elevation_axis, band_), along.step_m()), 0, 0};
    if (angle == 0) {
      entry.elevation_fwhm_m =
          width_at_half(peaks(across, on_axis(lateral, range_m), band_), across.step_m());
    }
    double power = 0;
    for (int node = 0; node < band_.nodes(); ++node) {
      const auto at = static_cast<std::size_t>(node);
      power += band_.weight(node) * power_m(along, at) * power_m(across, at);
    }
    entry.power_root = std::cbrt(power);
  }
}

double BeamProfile::interpolate(double range_m, double theta_rad, double Entry::*value) const {
  const BeamGrid::Between r = grid_.range_at(range_m), a = grid_.angle_at(theta_rad);
  const auto columns = static_cast<std::size_t>(grid_.angles());
  const auto along = [&](std::size_t row) {
    return (1 - a.share) * entries_[row * columns + a.first].*value +
           a.share * entries_[row * columns + a.second].*value;
  };
  return (1 - r.share) * along(r.first) + r.share * along(r.second);
}

double BeamProfile::lateral_fwhm_m(double range_m, double theta_rad) const {
  return interpolate(range_m, theta_rad, &Entry::lateral_fwhm_m);
}

double BeamProfile::elevation_fwhm_m(double range_m) const {
  return interpolate(range_m, 0, &Entry::elevation_fwhm_m);
}

double BeamProfile::resolution_cell_m3(double range_m) const {
  return lateral_fwhm_m(range_m) * elevation_fwhm_m(range_m) * axial_fwhm_m_;
}

double BeamProfile::level(double range_m, double theta_rad) const {
  const double root = interpolate(range_m, theta_rad, &Entry::power_root) /
                      interpolate(range_m, 0, &Entry::power_root);
  return std::pow(root, 1.5);
}

}  // namespace wobblebench::sim
