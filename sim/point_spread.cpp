#include "sim/point_spread.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::sim {

namespace {

double wavelength_m(const hw::AcquisitionPlan& plan) {
  return plan.acquisition().sound_speed_m_s / plan.probe().center_frequency_hz;
}

/// Width over F-number of a Gaussian whose product with another such, at the focus, has the two-way
/// width 0.886 lambda F#.
double one_way_width(const hw::AcquisitionPlan& plan) {
  return 0.886 * std::sqrt(2.0) * wavelength_m(plan);
}

}  // namespace

double axial_fwhm_m(const hw::AcquisitionPlan& plan) {
  const auto& probe = plan.probe();
  return 0.5 * plan.acquisition().sound_speed_m_s * 0.8825 /
         (probe.fractional_bandwidth * probe.center_frequency_hz);
}

double receive_aperture_m(const hw::AcquisitionPlan& plan, double range_m) {
  const auto& probe = plan.probe();
  return std::min(range_m / probe.f_number, probe.elements * probe.pitch_m);
}

double transmit_aperture_m(const hw::AcquisitionPlan& plan) {
  return receive_aperture_m(plan, plan.probe().transmit_focus_m);
}

double transmit_fwhm_m(const hw::AcquisitionPlan& plan, double range_m) {
  const double aperture = transmit_aperture_m(plan);
  return std::hypot(one_way_width(plan) * range_m / aperture,
                    aperture * (1 - range_m / plan.probe().transmit_focus_m));
}

double lateral_fwhm_m(const hw::AcquisitionPlan& plan, double range_m) {
  const double received = one_way_width(plan) * range_m / receive_aperture_m(plan, range_m);
  return 1 / std::hypot(1 / received, 1 / transmit_fwhm_m(plan, range_m));
}

double elevation_fwhm_m(const hw::AcquisitionPlan& plan, double range_m) {
  const auto& probe = plan.probe();
  const double diffraction = 0.886 * wavelength_m(plan) * range_m / probe.element_height_m;
  const double geometric = probe.element_height_m * std::abs(1 - range_m / probe.elevation_focus_m);
  return std::hypot(diffraction, geometric);
}

double frame_distance_m(const hw::AcquisitionPlan& plan, int line, double range_m) {
  const double radius_m = plan.probe().radius_m + range_m;
  const double to_axis_m = radius_m * std::cos(plan.theta_rad(line)) - plan.geometry().axis_z_m();
  return std::abs(to_axis_m) * plan.phi_step_rad();
}

double sigma_of_fwhm(double fwhm) {
  return fwhm / (2 * std::sqrt(2 * std::log(2.0)));
}

std::vector<float> unit_power_gaussian(double sigma_in_steps, int max_half) {
  constexpr double kCutSigmas = 3.035;  // exp(-kCutSigmas^2 / 2) = 0.01
  const int half = static_cast<int>(std::clamp<double>(kCutSigmas * sigma_in_steps, 0, max_half));
  std::vector<double> taps;
  double power = 0;
  for (int i = -half; i <= half; ++i) {
    const double tap = half == 0 ? 1 : std::exp(-0.5 * i * i / (sigma_in_steps * sigma_in_steps));
    taps.push_back(tap);
    power += tap * tap;
  }
  std::vector<float> unit;
  for (double tap : taps) unit.push_back(static_cast<float>(tap / std::sqrt(power)));
  return unit;
}

}  // namespace wobblebench::sim
