#include "sim/optics/beam_profile.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/units.h"
#include "sim/optics/beam_row.h"

namespace wobblebench::sim {

namespace {

constexpr double kRangeStep_m = 2.5e-3;
constexpr double kProfileAngleStep_rad = 1.1 * kDegree;
constexpr double kSampleRangeStep_m = 1e-3;  ///< between the ranges looked up for BeamAtSamples
constexpr double kSampleAngleStep_rad = 1 * kDegree;
/// Where half of the aperture is missing, lobes are twice as wide and lie on one side.
constexpr double kMissing = 3;
constexpr int kMinRanges = 8, kMaxRanges = 64;
constexpr int kProfileColumns = 40;  ///< a side

/// Half of the widest beam that is sampled: two lobes, and half of the aperture's geometric shadow.
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

/// Distance between the first points on either side of the peak at which the profile has half of
/// it.
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

float squared(double x) {
  return static_cast<float>(x * x);
}

float mixed(float a, float b, float share) {
  return a + share * (b - a);
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

BeamProfile::BeamProfile(const ProbeOptics& optics)
    : grid_(optics.plan(), kRangeStep_m, kProfileAngleStep_rad),
      axial_fwhm_m_(optics.axial_fwhm_m()) {
  entries_.resize(static_cast<std::size_t>(grid_.ranges() * grid_.angles()));
  parallel_ranges(grid_.ranges(), optics.threads(), [&](int first, int last) {
    for (int range = first; range < last; ++range) measure(optics, range);
  });
}

void BeamProfile::measure(const ProbeOptics& optics, int range) {
  const double range_m = grid_.range_m(range);
  const auto& probe = optics.probe();
  const PulseBand& band = optics.band();
  const double height_m = probe.element_height_m, wavelength_m = optics.wavelength_m();
  const PlaneResponse elevation = PlaneResponse::elevation(optics, range_m);
  const SampledRow across = sample_row(
      elevation,
      range_m,
      window_m(wavelength_m * range_m / height_m, height_m, range_m, probe.elevation_focus_m),
      true,
      kProfileColumns);
  const PulseBand::Values elevation_axis = elevation.on_axis(range_m);
  const double lateral_window_m =
      window_m(kMissing * wavelength_m * range_m / optics.receive_aperture_m(range_m),
               optics.transmit_aperture_m(range_m),
               range_m,
               optics.transmit_focus_m(range_m));
  for (int angle = 0; angle < grid_.angles(); ++angle) {
    const StickAperture aperture(optics, grid_.angle_rad(angle));
    Entry& entry = entries_[static_cast<std::size_t>(range * grid_.angles() + angle)];
    if (angle > 0 && aperture.whole(range_m)) {  // the middle stick's beam
      entry = entries_[static_cast<std::size_t>(range * grid_.angles())];
      continue;
    }
    const PlaneResponse lateral = PlaneResponse::lateral(aperture, range_m);
    const SampledRow along = sample_row(lateral, range_m, lateral_window_m, true, kProfileColumns);
    entry = {width_at_half(peaks(along, elevation_axis, band), along.step_m()), 0, 0};
    if (angle == 0) {
      entry.elevation_fwhm_m =
          width_at_half(peaks(across, lateral.on_axis(range_m), band), across.step_m());
    }
    double power = 0;
    for (int node = 0; node < band.nodes(); ++node) {
      const auto at = static_cast<std::size_t>(node);
      power += band.weight(node) * along.power_m(at) * across.power_m(at);
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

BeamAtSamples::BeamAtSamples(const hw::AcquisitionPlan& plan,
                             const BeamProfile& profile,
                             double spacing_m,
                             int samples)
    : samples_(samples) {
  const int last = plan.acquisition().sticks_per_frame - 1;
  const double farthest = std::max(std::abs(plan.theta_rad(0)), std::abs(plan.theta_rad(last)));
  angles_ = 1 + static_cast<int>(std::ceil(farthest / kSampleAngleStep_rad));
  angle_step_rad_ = angles_ > 1 ? farthest / (angles_ - 1) : 1;
  const int stride = std::max(1, static_cast<int>(kSampleRangeStep_m / spacing_m));
  for (int a = 0; a < angles_; ++a) {
    const auto look_up = [&](int sample) {
      const double range_m = (sample + 0.5) * spacing_m, theta = a * angle_step_rad_;
      const double level = profile.level(range_m, theta);
      return BeamAtSample{squared(power_sigma(profile.lateral_fwhm_m(range_m, theta))),
                          squared(power_sigma(profile.elevation_fwhm_m(range_m))),
                          squared(level)};
    };
    BeamAtSample from = look_up(0), to = look_up(stride);
    for (int i = 0; i < samples; ++i) {
      if (i > 0 && i % stride == 0) {
        from = to;
        to = look_up(i + stride);
      }
      const float share = static_cast<float>(i % stride) / static_cast<float>(stride);
      table_.push_back({mixed(from.lateral2, to.lateral2, share),
                        mixed(from.elevation2, to.elevation2, share),
                        mixed(from.level2, to.level2, share)});
    }
  }
}

const BeamAtSample* BeamAtSamples::of(double theta_rad) const {
  const double steps = std::round(std::abs(theta_rad) / angle_step_rad_);
  const auto angle = static_cast<std::size_t>(std::min(steps, angles_ - 1.0));
  return table_.data() + angle * static_cast<std::size_t>(samples_);
}

}  // namespace wobblebench::sim
