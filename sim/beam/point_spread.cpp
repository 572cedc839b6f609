#include "sim/beam/point_spread.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace wobblebench::sim {

namespace {

double wavelength_m(const hw::AcquisitionPlan& plan) {
  return plan.acquisition().sound_speed_m_s / plan.probe().center_frequency_hz;
}

/// One-way width of an aperture at its focus, as a Gaussian whose product with an equal one has the
/// two-way width 0.886 lambda range / aperture. Elements at the edges of a curved face are less
/// sensitive, by sinc = 1 - q: the aperture's second moment shrinks by 1 - 4 q / 15.
double focused_width_m(const hw::AcquisitionPlan& plan, double aperture_m, double range_m) {
  const auto& probe = plan.probe();
  const double angle_rad = 0.5 * aperture_m * (1 / probe.radius_m + 1 / std::max(range_m, 1e-9));
  const double edge_phase =
      kPi * probe.pitch_m / wavelength_m(plan) * std::sin(std::min(angle_rad, 0.5 * kPi));
  const double edge_loss = std::min(edge_phase * edge_phase / 6, 1.0);
  return 0.886 * std::sqrt(2.0) * wavelength_m(plan) * range_m / aperture_m *
         (1 + 2 * edge_loss / 15);
}

/// Two-way width of a defocused aperture in units of lambda range / aperture, by the Fresnel number
/// of the defocus in steps of 0.1; from sim/beam/beam_pattern.h, scaled to give 0.886 at 0.
constexpr double kDefocusStep = 0.1;
constexpr double kDefocusedWidth[] = {0.886, 0.889, 0.899, 0.918, 0.954, 1.013, 1.114,
                                      1.279, 1.547, 1.956, 2.495, 3.017, 3.327, 3.430,
                                      3.486, 3.617, 3.869, 4.244, 4.702, 5.169, 5.565};
constexpr double kFarSlope = 3.05;  // beyond the table, within 5 %

double defocused_width(double fresnel_number) {
  constexpr int kLast = static_cast<int>(std::size(kDefocusedWidth)) - 1;
  const double position = fresnel_number / kDefocusStep;
  if (position >= kLast) {
    return kDefocusedWidth[kLast] + kFarSlope * (fresnel_number - kLast * kDefocusStep);
  }
  const auto before = static_cast<int>(position);
  const double share = position - before;
  return (1 - share) * kDefocusedWidth[before] + share * kDefocusedWidth[before + 1];
}

}  // namespace

double axial_fwhm_m(const hw::AcquisitionPlan& plan) {
  const auto& probe = plan.probe();
  return 0.5 * plan.acquisition().sound_speed_m_s * 0.8825 /
         (probe.fractional_bandwidth * probe.center_frequency_hz);
}

int iq_oversampling(const hw::AcquisitionPlan& plan) {
  const auto& acquisition = plan.acquisition();
  const double output_rate_hz = acquisition.sound_speed_m_s / (2 * plan.sample_spacing_m());
  const double band_hz = plan.probe().fractional_bandwidth * plan.probe().center_frequency_hz;
  // A Gaussian pulse is 29 dB down at 2.2 times its -6 dB band.
  return std::max(1, static_cast<int>(std::ceil(2.2 * band_hz / output_rate_hz)));
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
  const double focus_m = plan.probe().transmit_focus_m;
  return std::hypot(focused_width_m(plan, aperture, focus_m) * range_m / focus_m,
                    aperture * (1 - range_m / focus_m));
}

double lateral_fwhm_m(const hw::AcquisitionPlan& plan, double range_m) {
  const double received = focused_width_m(plan, receive_aperture_m(plan, range_m), range_m);
  return 1 / std::hypot(1 / received, 1 / transmit_fwhm_m(plan, range_m));
}

double elevation_fwhm_m(const hw::AcquisitionPlan& plan, double range_m) {
  const auto& probe = plan.probe();
  const double wavelength = wavelength_m(plan), height = probe.element_height_m;
  const double nearest_m = std::max(range_m, 1e-9);
  const double defocus =
      0.25 * height * height / wavelength * std::abs(1 / nearest_m - 1 / probe.elevation_focus_m);
  return wavelength * nearest_m / height * defocused_width(defocus);
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
