#include "hw/probe/beam_width.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <utility>

#include "base/units.h"
#include "tests/support/yardstick.h"

namespace wobblebench::hw {
namespace {

/// sinc(u)^2 falls to half at u = 0.4429: a two-way -6 dB width of that many wavelengths times
/// range over aperture, to both sides, where one aperture sends and receives in focus.
constexpr double kTwoWayWidth = 0.886;

/// A nearly flat array of small elements, with a pulse of one frequency.
ProbeOptions textbook_probe() {
  ProbeOptions probe;
  probe.radius_m = 200e-3;
  probe.fractional_bandwidth = 0.1;
  probe.pitch_m = 0.1e-3;
  probe.elements = 1024;
  return probe;
}

double wavelength_m(const AcquisitionPlan& plan) {
  return plan.acquisition().sound_speed_m_s / plan.probe().center_frequency_hz;
}

TEST(BeamWidth, InFocusIsThatOfALineAperture) {
  for (const double f_number : {3.0, 5.0}) {
    for (const double focus_m : {50e-3, 90e-3}) {
      ProbeOptions probe = textbook_probe();
      probe.f_number = f_number;
      probe.transmit_focus_m = focus_m;
      probe.elevation_focus_m = focus_m;
      const AcquisitionPlan plan(probe, {});
      const BeamWidth width = beam_width(plan, focus_m);
      const double expected_m = kTwoWayWidth * wavelength_m(plan);
      EXPECT_NEAR(width.lateral_m, expected_m * f_number, 0.04 * width.lateral_m);
      EXPECT_NEAR(width.elevation_m,
                  expected_m * focus_m / probe.element_height_m,
                  0.02 * width.elevation_m);
    }
  }
}

TEST(BeamWidth, FarBehindAFocusIsThatOfTheGeometricCone) {
  ProbeOptions probe = textbook_probe();
  probe.element_height_m = 30e-3;
  probe.elevation_focus_m = 40e-3;
  const AcquisitionPlan plan(probe, {});
  const double range_m = 150e-3;
  const double cone_m = probe.element_height_m * (range_m / probe.elevation_focus_m - 1);
  // At its edge each way has half the amplitude; 0.7 of it, for half both ways, lies within.
  EXPECT_LT(beam_width(plan, range_m).elevation_m, cone_m);
  EXPECT_GT(beam_width(plan, range_m).elevation_m, 0.8 * cone_m);
}

TEST(BeamWidth, ThroughAnArrayShorterThanTheApertureFollowsTheArray) {
  ProbeOptions probe = textbook_probe();
  probe.f_number = 1;
  probe.elements = 200;  // 20 mm
  probe.transmit_focus_m = 80e-3;
  const AcquisitionPlan plan(probe, {});
  const double expected_m = kTwoWayWidth * wavelength_m(plan) * 80e-3 / 20e-3;
  EXPECT_NEAR(beam_width(plan, 80e-3).lateral_m, expected_m, 0.04 * expected_m);
}

/// Pulse-echo widths of points, element by element, by the independent program of tests/yardstick.
TEST(BeamWidth, OfEachPresetIsNearThatOfTheElementSum) {
  for (const auto& [preset, table] : {std::pair{ProbePreset::standard, "standard"},
                                      {ProbePreset::c5_2v, "c5_2v"},
                                      {ProbePreset::curvilinear_60, "curvilinear_60"}}) {
    const ProbePresetData& data = probe_preset(preset);
    const AcquisitionPlan plan(data.probe, {.sector_rad = data.sector_rad});
    int compared = 0;
    for (const auto& row : yardstick("point_widths", table)) {
      const double range_m = row.number("depth_mm") * kMillimetre;
      if (row.number("theta_deg") != 0 || range_m < 50e-3 || range_m > 110e-3) continue;
      const BeamWidth width = beam_width(plan, range_m);
      const std::string at = std::string(table) + ", " + std::to_string(range_m) + " m";
      EXPECT_NEAR(width.lateral_m / kMillimetre / row.number("lateral_mm"), 1, 0.2) << at;
      EXPECT_NEAR(width.elevation_m / kMillimetre / row.number("elevation_mm"), 1, 0.2) << at;
      ++compared;
    }
    EXPECT_GE(compared, 3) << table;
  }
}

TEST(BeamWidth, IsNoneAcrossAnApertureThatIsNotKnown) {
  ProbeOptions no_array, no_lens, other;
  no_array.elements = 0;
  no_lens.element_height_m = 0;
  other.f_number = 2;
  other.element_height_m = 8e-3;
  const BeamWidth whole = beam_width(AcquisitionPlan({}, {}), 80e-3);
  const BeamWidth flat = beam_width(AcquisitionPlan(no_array, {}), 80e-3);
  const BeamWidth tall = beam_width(AcquisitionPlan(no_lens, {}), 80e-3);
  EXPECT_EQ(flat.lateral_m, 0);
  EXPECT_EQ(flat.elevation_m, whole.elevation_m);
  EXPECT_EQ(tall.lateral_m, whole.lateral_m);
  EXPECT_EQ(tall.elevation_m, 0);
  EXPECT_EQ(with_aperture_of({}, other), ProbeOptions{});
  EXPECT_EQ(with_aperture_of(no_array, other).f_number, 2);
  EXPECT_EQ(with_aperture_of(no_array, other).element_height_m, ProbeOptions{}.element_height_m);
  EXPECT_EQ(with_aperture_of(no_lens, other).element_height_m, 8e-3);
  EXPECT_NO_THROW(AcquisitionPlan(no_array, {}));
  EXPECT_THROW(validate(no_array), InvalidOption);
  ProbeOptions wrong;
  wrong.elements = -1;
  EXPECT_THROW(AcquisitionPlan(wrong, {}), InvalidOption);
}

TEST(BeamWidth, AtNoRangeIsRefused) {
  EXPECT_THROW(beam_width(AcquisitionPlan({}, {}), 0), std::invalid_argument);
}

TEST(BeamWidths, AreThoseOfTheirRangesAndLinearBetween) {
  const AcquisitionPlan plan({}, {});
  const BeamWidths widths(plan);
  const double step_m = (widths.last_m() - widths.first_m()) / (BeamWidths::kRows - 1);
  const double first_m = widths.first_m() + 9 * step_m;
  const BeamWidth a = beam_width(plan, first_m), b = beam_width(plan, first_m + step_m);
  EXPECT_NEAR(widths.at(first_m).lateral_m, a.lateral_m, 1e-9);
  EXPECT_NEAR(widths.at(first_m + 0.25 * step_m).elevation_m,
              0.75 * a.elevation_m + 0.25 * b.elevation_m,
              1e-9);
  EXPECT_EQ(widths.at(0).lateral_m, widths.rows().front().lateral_m);
  EXPECT_EQ(widths.at(1).elevation_m, widths.rows().back().elevation_m);
}

TEST(BeamWidths, ExistForTheEndsOfTheirOptions) {
  for (const double depth_m : {1e-3, 0.4}) {
    for (const int elements : {1, 1024}) {
      for (const double radius_m : {1e-3, 0.2}) {
        ProbeOptions probe;
        probe.elements = elements;
        probe.radius_m = radius_m;
        probe.wobble_radius_m = 0;
        probe.fractional_bandwidth = 1.5;
        AcquisitionOptions acquisition;
        acquisition.depth_m = depth_m;
        const BeamWidths widths({probe, acquisition});
        for (const BeamWidth& width : widths.rows()) {
          EXPECT_GT(width.lateral_m, 0);
          EXPECT_LT(width.lateral_m, 10);
          EXPECT_GT(width.elevation_m, 0);
          EXPECT_LT(width.elevation_m, 10);
        }
      }
    }
  }
}

}  // namespace
}  // namespace wobblebench::hw
