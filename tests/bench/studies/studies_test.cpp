// Studies of the simulated probe at sizes that take seconds; `wobblebench validate` runs them
// whole.
#include <gtest/gtest.h>

#include <cmath>

#include "bench/studies/validate/attenuation.h"
#include "bench/studies/validate/point_targets.h"
#include "bench/studies/validate/reflection.h"
#include "bench/studies/validate/repeatability.h"
#include "bench/studies/validate/rung_agreement.h"
#include "bench/studies/validate/shear.h"
#include "bench/studies/validate/speckle_motion.h"
#include "bench/studies/validate/speckle_size.h"
#include "bench/studies/validate/speckle_statistics.h"
#include "phantoms/material.h"

namespace wobblebench::bench {
namespace {

using sim::Rung;

TEST(SpeckleStudy, FieldIsRayleigh) {
  SpeckleInputs inputs;
  inputs.seeds = seeds_from(1, 2);
  const auto result = measure_speckle(Rung::field, inputs);
  EXPECT_NEAR(result.envelope.snr(), rayleigh_snr(), 0.03);
  EXPECT_NEAR(result.intensity.snr(), 1, 0.03);
  EXPECT_NEAR(result.envelope.mean(), 1, 0.02);
  EXPECT_EQ(result.rejected(), 0);
}

TEST(SpeckleStudy, FewScatterersDifferFromMany) {
  SpeckleInputs inputs;
  inputs.seeds = {1};
  inputs.scatterers_per_cell = 1;
  const auto few = measure_speckle(Rung::scatterers, inputs);
  inputs.scatterers_per_cell = 30;
  const auto many = measure_speckle(Rung::scatterers, inputs);
  EXPECT_LT(few.envelope.snr(), 1.8);
  EXPECT_NEAR(many.envelope.snr(), rayleigh_snr(), 0.05);
  EXPECT_EQ(few.rejected(), 1);
  EXPECT_NEAR(few.envelope.mean_square() / many.envelope.mean_square(), 1, 0.05);
}

TEST(PointTargetStudy, WidthsInTheFocusAreThoseOfTheFormulas) {
  const auto found = measure_point(Rung::scatterers, 75e-3, false, {.across = 25});
  EXPECT_NEAR(found.axial.fwhm_m / found.axial.formula_m, 1, 0.05);
  EXPECT_NEAR(found.lateral.fwhm_m / found.lateral.formula_m, 1, 0.05);
  EXPECT_NEAR(found.elevation.fwhm_m / found.elevation.formula_m, 1, 0.05);
}

TEST(AgreementStudy, ScatterersInTheFocusAreThoseOfTheReference) {
  AgreementInputs inputs;
  inputs.sticks = 4;
  inputs.sector_rad = 2 * kDegree;
  inputs.half_width_m = 5e-3;
  const auto found = measure_agreement(75e-3, inputs);
  // Tissue wider than the beam: its main lobe alone misses a little.
  EXPECT_GE(found.main_lobe, 0.95);
  EXPECT_GE(found.side_lobes, 0.98);
}

TEST(SpeckleSizeStudy, FieldIsAsWideAsThePointSpread) {
  SpeckleSizeInputs inputs;
  inputs.ranges_m = {75e-3};
  inputs.seeds = {1};
  for (const auto direction :
       {BeamDirection::axial, BeamDirection::lateral, BeamDirection::elevation}) {
    const auto found = measure_speckle_size(Rung::field, direction, inputs).front();
    EXPECT_NEAR(found.fwhm_m / found.expected_m, 1, 0.07) << static_cast<int>(direction);
  }
}

TEST(SpeckleMotionStudy, ScatterersFollowTheTissueAndFieldStays) {
  SpeckleMotionInputs inputs;
  inputs.sticks = 24;
  inputs.frames = 16;
  for (const auto& found : measure_speckle_motion(Rung::scatterers, inputs)) {
    EXPECT_GE(found.followed, 0.95) << found.motion;
    EXPECT_LT(found.stayed, 0.5) << found.motion;
  }
  for (const auto& found : measure_speckle_motion(Rung::field, inputs)) {
    EXPECT_LT(found.followed, 0.3) << found.motion;
    EXPECT_NEAR(found.stayed, 1, 1e-3) << found.motion;
  }
}

TEST(AttenuationStudy, SlopeIsThatOfTheBand) {
  AttenuationInputs inputs;
  inputs.seeds = {1};
  const auto steady = measure_slope(Rung::field, false, inputs);
  // -n + n^2 s^2 / 2 is a parabola: its line from 20 to 120 mm has the slope at 70 mm, where
  // n = 0.5 * 3.5 * 2 * 7 dB and s = 0.6 / 2.3548.
  const double nepers = 0.5 * 3.5 * 2 * 7 / 8.685890;
  const double expected = -3.5 * (1 - nepers * std::pow(0.6 / 2.354820, 2));
  EXPECT_NEAR(steady.expected_db_per_cm, expected, 1e-3);
  EXPECT_NEAR(steady.slope_db_per_cm, expected, 1e-3);
  EXPECT_NEAR(measure_slope(Rung::field, true, inputs).slope_db_per_cm, expected, 0.07);
}

TEST(AttenuationStudy, BoneAndFluidChangeTheLevelBehindThem) {
  AttenuationInputs inputs;
  inputs.seeds = {1};
  inputs.sticks = inputs.frames = 8;
  const auto shadow = measure_bone_shadow(Rung::field, inputs);
  EXPECT_LT(shadow.expected_behind_db, -15);
  EXPECT_NEAR(shadow.behind_db, shadow.expected_behind_db, 1);
  const auto enhancement = measure_cyst_enhancement(Rung::field, inputs);
  EXPECT_GT(enhancement.expected_behind_db, 10);
  EXPECT_NEAR(enhancement.behind_db, enhancement.expected_behind_db, 1);
}

TEST(ReflectionStudy, FresnelHasItsLimits) {
  const auto& fluid = phantoms::material("amniotic_fluid");
  const auto& bone = phantoms::material("cortical_bone");
  EXPECT_NEAR(fresnel(fluid, bone, 0), (6.5 - 1.51) / (6.5 + 1.51), 1e-12);
  EXPECT_EQ(fresnel(fluid, bone, std::asin(1530.0 / 3432) + 1e-6), 1);
  EXPECT_LT(fresnel(fluid, bone, std::asin(1530.0 / 3432) - 1e-3), 1);
}

TEST(ReflectionStudy, SpecularEchoesFollowTheLobeAndFresnel) {
  ReflectionInputs inputs;
  inputs.lobe_deg = {0, 1.5, 3};
  inputs.fresnel_deg = {0, 20, 30};
  for (const auto& point : measure_lobe(inputs)) {
    EXPECT_NEAR(point.measured, point.expected, 1e-3) << point.angle_rad / kDegree;
  }
  for (const auto& point : measure_fresnel(inputs)) {
    EXPECT_NEAR(point.measured, point.expected, 0.02) << point.angle_rad / kDegree;
  }
}

TEST(ReflectionStudy, ARoughPlaneEchoesByTheCosine) {
  ReflectionInputs inputs;
  inputs.seeds = {1};
  inputs.diffuse_bin_deg = 12;
  for (const auto& point : measure_diffuse(Rung::field, inputs)) {
    EXPECT_NEAR(20 * std::log10(point.measured / point.expected), 0, 1) << point.n << " sticks";
  }
}

TEST(ShearStudy, AMovingSphereIsWhereStickTimesSay) {
  const auto results = measure_shear({.sticks = 33, .frames = 19, .samples = 4096});
  ASSERT_EQ(results.size(), 3u);
  for (const auto& result : results) {
    EXPECT_GT(result.n, 20) << result.motion;
    EXPECT_LE(result.largest_error_m, result.allowed_m) << result.motion;
    EXPECT_GT(result.largest_shear_m, 20 * result.allowed_m) << result.motion;
  }
}

TEST(RepeatabilityStudy, BytesDependOnTheSeedAlone) {
  RepeatabilityInputs inputs;
  inputs.phantom = "sphere";
  inputs.voxel_m = 2e-3;
  inputs.acquisition = {.sticks_per_frame = 12, .samples_per_stick = 256, .frames_per_volume = 5};
  for (const Rung rung : {Rung::geometry, Rung::field, Rung::scatterers}) {
    for (const bool moving : {false, true}) {
      const auto found = measure_repeatability(rung, moving, inputs);
      EXPECT_EQ(found.runs, 4);
      EXPECT_EQ(found.differing, 0) << static_cast<int>(rung) << moving;
      if (rung == Rung::geometry) {
        EXPECT_EQ(found.other_seed, 0);
      } else {
        EXPECT_GT(found.other_seed, 0.5);
      }
    }
  }
}

}  // namespace
}  // namespace wobblebench::bench
