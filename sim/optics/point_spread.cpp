#include "sim/optics/point_spread.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::sim {

double wavelength_m(const hw::AcquisitionPlan& plan) {
  return plan.acquisition().sound_speed_m_s / plan.probe().center_frequency_hz;
}

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

double transmit_focus_m(const hw::AcquisitionPlan& plan, double range_m) {
  const auto& acquisition = plan.acquisition();
  if (acquisition.focal_zones == 1) return plan.probe().transmit_focus_m;
  const double zone_m = acquisition.depth_m / acquisition.focal_zones;
  const double zone = std::floor(std::clamp(range_m, 0.0, acquisition.depth_m) / zone_m);
  return (std::min(zone, acquisition.focal_zones - 1.0) + 0.5) * zone_m;
}

double transmit_aperture_m(const hw::AcquisitionPlan& plan, double range_m) {
  return receive_aperture_m(plan, transmit_focus_m(plan, range_m));
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
