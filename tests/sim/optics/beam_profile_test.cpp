// Widths, levels and speckle sizes against the independent tables of tests/yardstick.
#include "sim/optics/beam_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>

#include "hw/probe/probe.h"
#include "tests/support/yardstick.h"

namespace wobblebench::sim {
namespace {

const hw::AcquisitionPlan& plan() {
  static const hw::AcquisitionPlan shared({}, {});
  return shared;
}

/// Of each preset, on sticks to the end of the array. Across lines it is the beam of one stick, as
/// it blurs an edge of tissue.
TEST(BeamProfile, WidthsAreThoseOfTheElementSum) {
  const std::pair<const char*, hw::ProbePreset> presets[] = {
      {"standard", hw::ProbePreset::standard},
      {"c5_2v", hw::ProbePreset::c5_2v},
      {"curvilinear_60", hw::ProbePreset::curvilinear_60}};
  for (const auto& [name, preset] : presets) {
    const hw::ProbePresetData& data = hw::probe_preset(preset);
    const BeamProfile profile{ProbeOptics({data.probe,
                                           {.depth_m = 0.17,
                                            .sector_rad = 1.25 * data.sector_rad,
                                            .sticks_per_frame = 321,
                                            .samples_per_stick = 4096,
                                            .frames_per_volume = 1}})};
    const auto turned = yardstick("point_widths", name), own = yardstick("stick_beam", name);
    ASSERT_EQ(turned.size(), own.size());
    for (std::size_t i = 0; i < own.size(); ++i) {
      const double range_m = own[i].number("depth_mm") * 1e-3;
      const double theta_rad = own[i].number("theta_deg") * kDegree;
      if (range_m < 30e-3) continue;
      const double tolerance = theta_rad == 0 ? 0.05 : 0.1;
      EXPECT_NEAR(profile.lateral_fwhm_m(range_m, theta_rad) * 1e3 / own[i].number("lateral_mm"),
                  1,
                  tolerance)
          << name << " " << range_m << " " << theta_rad / kDegree;
      EXPECT_NEAR(
          profile.elevation_fwhm_m(range_m) * 1e3 / turned[i].number("elevation_mm"), 1, tolerance)
          << name << " " << range_m << " " << theta_rad / kDegree;
    }
  }
}

/// Elements of several wavelengths hear little of what lies far off their own axes.
TEST(BeamProfile, WideElementsAreDirective) {
  for (const auto& row : yardstick("wide_elements")) {
    hw::ProbeOptions probe;
    probe.pitch_m = row.number("pitch_mm") * 1e-3;
    probe.elements = static_cast<int>(row.number("elements"));
    const BeamProfile profile{ProbeOptics({probe, {}})};
    const double range_m = row.number("depth_mm") * 1e-3;
    EXPECT_NEAR(profile.lateral_fwhm_m(range_m, 0) * 1e3 / row.number("lateral_mm"), 1, 0.06)
        << probe.pitch_m << " " << range_m;
  }
}

/// Sticks whose aperture is whole have the middle stick's beam, also where it is narrower than the
/// two middle elements.
TEST(BeamProfile, LevelsOfApodisedSticksAreOneNearTheFace) {
  for (const auto apodisation : {Apodisation::rectangular, Apodisation::hann, Apodisation::tukey}) {
    SimulationOptions options;
    options.apodisation = apodisation;
    const BeamProfile profile{ProbeOptics(plan(), options)};
    for (const double range_m : {0.2e-3, 1e-3, 3e-3, 10e-3}) {
      EXPECT_NEAR(profile.level(range_m, 10 * kDegree), 1, 1e-9) << range_m;
    }
  }
}

TEST(BeamProfile, LevelsAreThoseOfTheElementSum) {
  const BeamProfile profile{ProbeOptics(plan())};
  std::map<std::string, double> axis_db;  // by depth
  for (const auto& row : yardstick("speckle", "standard")) {
    const double range_m = row.number("depth_mm") * 1e-3;
    if (row.number("sector_fraction") == 0) axis_db[row.text("depth_mm")] = row.number("level_db");
    const double level = profile.level(range_m, row.number("theta_deg") * kDegree);
    EXPECT_NEAR(
        20 * std::log10(level), row.number("level_db") - axis_db.at(row.text("depth_mm")), 0.8)
        << range_m << " " << row.number("theta_deg");
  }
}

}  // namespace
}  // namespace wobblebench::sim
