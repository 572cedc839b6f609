// The beam's response against closed forms and brute force, and its table against the response.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>

#include "sim/beam/beam_pattern.h"
#include "sim/beam/beam_table.h"
#include "sim/beam/point_spread.h"

namespace wobblebench::sim {
namespace {

using Complex = std::complex<double>;

const hw::AcquisitionPlan& plan() {
  static const hw::AcquisitionPlan shared({}, {});
  return shared;
}

double sinc(double x) {
  return x == 0 ? 1 : std::sin(kPi * x) / (kPi * x);
}

/// The aperture's integral by a fine midpoint rule, in double precision.
Complex brute_force(const Aperture& aperture, double k, double range_m, double offset_m) {
  constexpr int kSources = 4000;
  Complex sum = 0;
  for (int i = 0; i < kSources; ++i) {
    const double u = ((i + 0.5) / kSources - 0.5) * aperture.width_m;
    const double strength = sinc(aperture.element_phase_per_m * u / kPi);
    const double aside = offset_m - u;
    sum += std::polar(strength, -0.5 * k * (aside * aside / range_m - u * u / aperture.focus_m));
  }
  return sum / static_cast<double>(kSources);
}

TEST(BeamPattern, InTheFocusItIsASinc) {
  const double k = 14280, width_m = 18e-3, focus_m = 75e-3;
  const double zero_m = 2 * kPi / k * focus_m / width_m;
  for (double share : {0.0, 0.3, 0.5, 0.9, 1.0, 1.5, 2.7}) {
    const Complex found = aperture_response({width_m, focus_m}, k, focus_m, share * zero_m);
    EXPECT_NEAR(std::abs(found), std::abs(sinc(share)), 2e-5) << share;
  }
}

TEST(BeamPattern, IsTheIntegralOverItsSources) {
  for (double range_m : {25e-3, 60e-3, 140e-3}) {
    for (double offset_m : {0.0, 0.7e-3, 3e-3, 8e-3}) {
      for (double phase_per_m : {0.0, 110.0}) {
        const Aperture aperture{14e-3, 75e-3, phase_per_m};
        const Complex found = aperture_response(aperture, 14280, range_m, offset_m);
        EXPECT_LT(std::abs(found - brute_force(aperture, 14280, range_m, offset_m)), 2e-3)
            << range_m << " " << offset_m << " " << phase_per_m;
      }
    }
  }
}

TEST(BeamPattern, TwoWayResponseHasTheWidthsOfTheFormulas) {
  const double frequency_hz = plan().probe().center_frequency_hz, focus_m = 75e-3;
  const auto at_half = [&](const auto& response, double fwhm_m) {
    return std::abs(response(plan(), frequency_hz, focus_m, 0.5 * fwhm_m)) /
           std::abs(response(plan(), frequency_hz, focus_m, 0));
  };
  EXPECT_NEAR(at_half(lateral_response, lateral_fwhm_m(plan(), focus_m)), 0.5, 0.02);
  EXPECT_NEAR(at_half(elevation_response, elevation_fwhm_m(plan(), focus_m)), 0.5, 0.005);
}

class BeamShapes : public testing::TestWithParam<BeamShape> {};

TEST_P(BeamShapes, ColumnsAreTheResponseInTheirMiddle) {
  const BeamTable table(plan(), GetParam());
  const double frequency_hz = plan().probe().center_frequency_hz;
  // Columns are averages over the band, smoother than the response at the centre frequency.
  const std::map<double, double> within = {{40e-3, 0.08}, {75e-3, 0.05}, {120e-3, 0.05}};
  for (const auto& [range_m, tolerance] : within) {
    const int row = table.row(range_m);
    const double middle_m = (row + 0.5) / table.rows_per_m();
    const auto response = [&](double offset_m) {
      return std::abs(lateral_response(plan(), frequency_hz, middle_m, offset_m));
    };
    for (int column = 0; column < table.columns(); ++column) {
      const double offset_m =
          (column + 0.5) / table.columns() * table.reach_m(table.lateral(), row);
      const BeamTable::Value& at =
          table.lateral().values[static_cast<std::size_t>(row * table.columns() + column)];
      EXPECT_NEAR(at.amplitude, response(offset_m) / response(0), tolerance)
          << range_m << " " << column;
    }
  }
}

TEST_P(BeamShapes, ReachLeavesOutTheSameShareOfPowerAtEveryRange) {
  const BeamTable table(plan(), GetParam());
  const bool main_lobe = GetParam() == BeamShape::main_lobe;
  const double beyond = main_lobe ? 0.01 : 5e-5;
  const double frequency_hz = plan().probe().center_frequency_hz;
  constexpr double kStep_m = 5e-6;
  for (int row = 10; row < table.rows(); row += 13) {
    const double range_m = (row + 0.5) / table.rows_per_m();
    const double reach_m = table.reach_m(table.elevation(), row);
    double within = 0, outside = 0;
    for (int i = 0; i < 8000; ++i) {
      const double offset_m = (i + 0.5) * kStep_m;
      const double power = std::norm(elevation_response(plan(), frequency_hz, range_m, offset_m));
      (offset_m < reach_m ? within : outside) += power;
    }
    // The search ends at the third side lobe; in the near field there is a little power beyond.
    EXPECT_LT(outside / (within + outside), main_lobe ? 1.1 * beyond : 8 * beyond) << range_m;
    const double wavelength_m = 1540 / frequency_hz;
    const double zero_m = wavelength_m * range_m / plan().probe().element_height_m;
    if (reach_m > 0.801 * zero_m) {
      EXPECT_GT(outside / (within + outside), 0.9 * beyond) << range_m;
    }
    EXPECT_GT(reach_m, 0.799 * zero_m) << range_m;
  }
}

INSTANTIATE_TEST_SUITE_P(All,
                         BeamShapes,
                         testing::Values(BeamShape::main_lobe, BeamShape::side_lobes));

}  // namespace
}  // namespace wobblebench::sim
