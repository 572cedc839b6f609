#include "sim/optics/probe_optics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/units.h"
#include "sim/optics/element_sum.h"
#include "sim/optics/plane_response.h"
#include "sim/speckle/iq_field.h"
#include "tests/support/yardstick.h"

namespace wobblebench::sim {
namespace {

const hw::AcquisitionPlan& default_plan() {
  static const hw::AcquisitionPlan plan({}, {});
  return plan;
}

TEST(PointSpread, AxialWidthFollowsTheBandwidth) {
  // c = 1540 m/s, f0 = 3.5 MHz, B = 0.6: worked by hand.
  EXPECT_NEAR(axial_fwhm_m(default_plan()), 0.3236e-3, 1e-7);
}

TEST(PointSpread, EachZoneHasItsFocus) {
  hw::AcquisitionOptions acquisition;
  acquisition.depth_m = 0.12;
  acquisition.focal_zones = 3;
  const hw::AcquisitionPlan plan({}, acquisition);
  for (const auto& [range_m, focus_m] :
       {std::pair(0.0, 0.02), {39e-3, 0.02}, {41e-3, 0.06}, {81e-3, 0.1}, {0.12, 0.1}}) {
    EXPECT_NEAR(ProbeOptics(plan).transmit_focus_m(range_m), focus_m, 1e-12) << range_m;
    EXPECT_NEAR(ProbeOptics(plan).transmit_aperture_m(range_m), focus_m / 4, 1e-12) << range_m;
  }
  EXPECT_EQ(ProbeOptics(default_plan()).transmit_focus_m(20e-3), 75e-3);
}

TEST(PointSpread, ApertureEndsWithTheElements) {
  hw::ProbeOptions probe;
  probe.elements = 32;
  const hw::AcquisitionPlan few(probe, {});
  EXPECT_NEAR(ProbeOptics(few).receive_aperture_m(40e-3), 10e-3, 1e-12);
  EXPECT_NEAR(ProbeOptics(few).receive_aperture_m(160e-3), 32 * 0.42e-3, 1e-12);
  EXPECT_NEAR(ProbeOptics(few).transmit_aperture_m(40e-3), 32 * 0.42e-3, 1e-12);
  EXPECT_NEAR(ProbeOptics(default_plan()).transmit_aperture_m(40e-3), 75e-3 / 4, 1e-12);
}

/// A short array lies aside of most sticks: all its elements within the F-number's length are used.
TEST(PointSpread, ShortArraysUseTheElementsThatExist) {
  for (const auto& row : yardstick("short_arrays")) {
    hw::ProbeOptions probe;
    probe.elements = static_cast<int>(row.number("elements"));
    const ProbeOptics optics{hw::AcquisitionPlan(probe, {})};
    const double range_m = row.number("depth_mm") * 1e-3;
    const double theta_rad = row.number("angle_deg") * kDegree;
    const auto level_db = [&](double of_rad) {
      return 20 * std::log10(ElementSum(optics, of_rad).on_axis(range_m));
    };
    EXPECT_NEAR(level_db(theta_rad) - level_db(0), row.number("level_db"), 0.2)
        << probe.elements << " " << row.text("angle_deg") << " " << range_m;
    const auto beam_db = [&](double of_rad) {
      const StickAperture aperture(optics, of_rad);
      auto echo = PlaneResponse::lateral(aperture, range_m).on_axis(range_m);
      const auto across = PlaneResponse::elevation(optics, range_m).on_axis(range_m);
      for (std::size_t node = 0; node < echo.size(); ++node) echo[node] *= across[node];
      return 20 * std::log10(optics.band().peak(echo));
    };
    EXPECT_NEAR(beam_db(theta_rad) - beam_db(0), row.number("level_db"), 0.3)
        << probe.elements << " " << row.text("angle_deg") << " " << range_m;
  }
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
