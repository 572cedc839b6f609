#include "sim/beam/point_spread.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "sim/beam/beam_pattern.h"

namespace wobblebench::sim {
namespace {

const hw::AcquisitionPlan& default_plan() {
  static const hw::AcquisitionPlan plan({}, {});
  return plan;
}

TEST(PointSpread, WidthsFollowTheFormulas) {
  // c = 1540 m/s, f0 = 3.5 MHz, B = 0.6, F# = 4, height 13.5 mm: worked by hand.
  EXPECT_NEAR(axial_fwhm_m(default_plan()), 0.3236e-3, 1e-7);
  // 1.5594 mm by flat apertures; the outermost elements turn by 1.0547, so that q = 0.1854.
  EXPECT_NEAR(lateral_fwhm_m(default_plan(), 75e-3), 1.5594e-3 * 1.02472, 2e-7)
      << "at the transmit focus";
  EXPECT_NEAR(elevation_fwhm_m(default_plan(), 75e-3), 2.1658e-3, 1e-7);
}

TEST(PointSpread, ElevationIsNarrowestNearItsFocus) {
  const double at_focus = elevation_fwhm_m(default_plan(), 75e-3);
  EXPECT_GT(elevation_fwhm_m(default_plan(), 25e-3), 2 * at_focus);
  EXPECT_GT(elevation_fwhm_m(default_plan(), 150e-3), 2 * at_focus);
  EXPECT_NEAR(elevation_fwhm_m(default_plan(), 0), 0.763 * 13.5e-3, 0.05e-3) << "of its shadow";
}

/// FWHM of the Gaussian with the same (integral of power)^2 / integral of power^2.
double equivalent_fwhm_m(const hw::AcquisitionPlan& plan, double range_m) {
  constexpr int kSteps = 4000;
  const double step_m = 15e-3 / kSteps;
  double sum = 0, square = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double power = std::norm(
        elevation_response(plan, plan.probe().center_frequency_hz, range_m, (i + 0.5) * step_m));
    sum += 2 * step_m * power;
    square += 2 * step_m * power * power;
  }
  return 2.3548 * sum * sum / square / std::sqrt(2 * kPi);
}

TEST(PointSpread, ElevationIsAsWideAsTheDiffractedBeam) {
  for (double range_m = 25e-3; range_m < 160e-3; range_m += 7e-3) {
    EXPECT_NEAR(
        elevation_fwhm_m(default_plan(), range_m) / equivalent_fwhm_m(default_plan(), range_m),
        1,
        0.06)
        << range_m;
  }
}

TEST(PointSpread, LateralWidensToThatOfTheReceivingApertureAlone) {
  const double at_focus = lateral_fwhm_m(default_plan(), 75e-3);
  for (double range_m : {30e-3, 50e-3, 100e-3, 160e-3}) {
    EXPECT_GT(lateral_fwhm_m(default_plan(), range_m), at_focus);
    // Directivity reduces the effective aperture a little more as it grows.
    EXPECT_LT(lateral_fwhm_m(default_plan(), range_m), 1.05 * std::sqrt(2.0) * at_focus);
  }
  EXPECT_NEAR(lateral_fwhm_m(default_plan(), 20e-3), std::sqrt(2.0) * at_focus, 0.05 * at_focus);
}

TEST(PointSpread, ApertureEndsWithTheElements) {
  hw::ProbeOptions probe;
  probe.elements = 32;
  const hw::AcquisitionPlan few(probe, {});
  EXPECT_NEAR(receive_aperture_m(few, 40e-3), 10e-3, 1e-12);
  EXPECT_NEAR(receive_aperture_m(few, 160e-3), 32 * 0.42e-3, 1e-12);
  EXPECT_GT(lateral_fwhm_m(few, 160e-3), 2 * lateral_fwhm_m(default_plan(), 160e-3));
}

TEST(PointSpread, KernelKeepsThePowerOfWhiteNoise) {
  for (double sigma : {0.0, 0.1, 0.5, 0.88, 2.0, 7.5, 100.0}) {
    const auto taps = unit_power_gaussian(sigma, 32);
    double power = 0;
    for (float tap : taps) power += static_cast<double>(tap) * static_cast<double>(tap);
    EXPECT_NEAR(power, 1, 1e-6) << "sigma " << sigma;
    EXPECT_EQ(taps.size() % 2, 1u);
    EXPECT_LE(taps.size(), 65u);
  }
}

TEST(PointSpread, KernelHasTheWidthAskedFor) {
  const auto taps = unit_power_gaussian(10.0, 64);
  const std::size_t middle = taps.size() / 2;
  const double half = 10.0 * std::sqrt(2 * std::log(2.0));
  const auto below = static_cast<std::size_t>(half);
  EXPECT_GT(taps[middle + below], taps[middle] / 2);
  EXPECT_LT(taps[middle + below + 1], taps[middle] / 2);
}

TEST(PointSpread, FwhmOfAGaussianIs2point3548Sigma) {
  EXPECT_NEAR(sigma_of_fwhm(2.354820), 1, 1e-6);
}

}  // namespace
}  // namespace wobblebench::sim
