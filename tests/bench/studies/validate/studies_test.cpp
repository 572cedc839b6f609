// Studies of the simulated probe at sizes that take seconds; `wobblebench validate` runs them
// whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bench/studies/validate/losses/attenuation.h"
#include "bench/studies/validate/losses/losses.h"
#include "bench/studies/validate/losses/reflection.h"
#include "bench/studies/validate/points/point_targets.h"
#include "bench/studies/validate/points/rung_agreement.h"
#include "bench/studies/validate/repeatability.h"
#include "bench/studies/validate/speckle/moving_tissue.h"
#include "bench/studies/validate/speckle/speckle_size.h"
#include "bench/studies/validate/speckle/speckle_statistics.h"
#include "phantoms/material.h"

namespace wobblebench::bench {
namespace {

using sim::Rung;

TEST(SpeckleStudy, FieldIsRayleigh) {
  const auto result = measure_speckle({.rung = Rung::field});
  EXPECT_NEAR(result.envelope.snr(), rayleigh_snr(), 0.03);
  EXPECT_NEAR(result.intensity.snr(), 1, 0.03);
  EXPECT_EQ(result.rejected(), 0);
  ASSERT_EQ(result.levels.size(), 9u);  // depths from 30 to 150 mm
  for (const auto& place : result.levels) {
    EXPECT_NEAR(place.measured.level_db, 0, 0.5) << place.expected.range_m;
  }
}

TEST(SpeckleStudy, FewScatterersDifferFromMany) {
  SpeckleInputs inputs{.seeds = {1}, .from_m = 60e-3, .to_m = 90e-3};
  inputs.scatterers_per_cell = 1;
  const auto few = measure_speckle(inputs);
  inputs.scatterers_per_cell = 30;
  const auto many = measure_speckle(inputs);
  EXPECT_LT(few.envelope.snr(), 1.8);
  EXPECT_NEAR(many.envelope.snr(), rayleigh_snr(), 0.05);
  EXPECT_EQ(few.rejected(), 1);
}

/// One place of a table.
BeamRow row_at(const std::vector<BeamRow>& rows, double fraction, double range_m) {
  for (const BeamRow& row : rows) {
    const bool here =
        std::abs(row.sector_fraction - fraction) < 1e-9 && std::abs(row.range_m - range_m) < 1e-9;
    if (here) return row;
  }
  ADD_FAILURE() << "no such row";
  return {};
}

TEST(PointTargetStudy, ReferenceIsAsWideAsTheTable) {
  for (const double fraction : {0.0, 1.0}) {
    const BeamRow place = row_at(point_width_rows(hw::ProbePreset::standard), fraction, 75e-3);
    const auto found =
        measure_points(hw::ProbePreset::standard, {Rung::reference, false}, {&place, 1}).front();
    EXPECT_NEAR(found.measured.lateral_m / place.lateral_m, 1, 0.05) << fraction;
    EXPECT_NEAR(found.measured.elevation_m / place.elevation_m, 1, 0.05) << fraction;
    EXPECT_NEAR(found.measured.axial_m / place.axial_m, 1, 0.05) << fraction;
    EXPECT_NEAR(found.measured.level_db, place.level_db, 0.5) << fraction;
  }
}

TEST(PointTargetStudy, InFocusAttenuatedPointsAreThoseOfTheTable) {
  const BeamRow place = row_at(attenuated_rows(0.5), 0, 75e-3);
  const auto found = measure_attenuated_points(0.5, {&place, 1}).front();
  EXPECT_NEAR(found.measured.lateral_m / place.lateral_m, 1, 0.05);
  EXPECT_NEAR(found.measured.elevation_m / place.elevation_m, 1, 0.05);
  EXPECT_NEAR(found.measured.axial_m / place.axial_m, 1, 0.05);
  EXPECT_NEAR(found.measured.level_db, place.level_db, 0.5);
}

TEST(ShadowStudy, TheHalfPlaneLiesWhereTheTableHasIt) {
  for (const ShadowEdge& edge : measure_shadow_edges()) {
    EXPECT_NEAR(edge.level_db.front(), 0, 0.1);
    EXPECT_NEAR(edge.level_db.back(), -40, 0.5);
    if (edge.range_m < 75e-3) continue;
    const std::size_t middle = edge.crossing_m.size() / 2;
    EXPECT_NEAR(edge.crossing_m[middle], 0, 1e-9);
    EXPECT_NEAR(edge.level_db[middle], edge.expected_db[middle], 2.5) << edge.range_m;
  }
}

TEST(PointTargetStudy, FieldHasNoEchoOfAPoint) {
  const BeamRow place = row_at(point_width_rows(hw::ProbePreset::standard), 0, 75e-3);
  const auto found =
      measure_points(hw::ProbePreset::standard, {Rung::field, false}, {&place, 1}).front();
  EXPECT_NEAR(found.measured.lateral_m / place.lateral_m, 1, 0.05);
  EXPECT_TRUE(std::isnan(found.measured.axial_m));
  EXPECT_TRUE(std::isnan(found.measured.level_db));
}

TEST(AgreementStudy, ReferenceMakesTheTablesEchoes) {
  auto places = echo_places();
  // One on the axis and one at the edge, where a wrong sign of a coordinate would show.
  std::erase_if(places, [](const EchoPlace& place) {
    return std::abs(place.range_m - 75e-3) > 1e-6 ||
           (place.sector_fraction != 0 && place.sector_fraction != 1);
  });
  ASSERT_EQ(places.size(), 2u);
  for (const auto& found : measure_agreement({Rung::reference, false}, places)) {
    EXPECT_GE(found.correlation, 0.99) << found.sector_fraction;
    EXPECT_NEAR(found.level_db, 0, 0.5) << found.sector_fraction;
  }
  for (EchoPlace::Point& point : places[1].points) point.lateral_m *= -1;
  EXPECT_LT(measure_agreement({Rung::reference, false}, {&places[1], 1}).front().correlation, 0.9);
}

TEST(SpeckleSizeStudy, ScatterersWithSideLobesAreAsWideAsTheTable) {
  SpeckleSizeInputs inputs;
  inputs.rung = Rung::scatterers;
  inputs.side_lobes = true;
  const BeamRow place = row_at(speckle_rows(hw::ProbePreset::standard), 0, 75e-3);
  const auto size = measure_speckle_size(inputs, {&place, 1});
  const BeamRow& found = size.places.front().measured;
  EXPECT_NEAR(found.lateral_m / place.lateral_m, 1, 0.1);
  EXPECT_NEAR(found.elevation_m / place.elevation_m, 1, 0.1);
  EXPECT_NEAR(found.axial_m / place.axial_m, 1, 0.1);
  EXPECT_NEAR(found.level_db, 0, 0.5);
}

TEST(SpeckleNeighbours, AreThoseOfTheTable) {
  NeighbourInputs inputs;
  inputs.seeds = {1};
  const auto found = measure_neighbours(Rung::field, false, inputs);
  const auto table = neighbour_rows();
  ASSERT_EQ(found.size(), table.size());
  for (std::size_t i = 0; i < table.size(); ++i) {
    EXPECT_NEAR(found[i].line_correlation, table[i].line_correlation, 0.1) << table[i].range_m;
    EXPECT_NEAR(found[i].frame_correlation, table[i].frame_correlation, 0.1) << table[i].range_m;
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
  const auto level_db = [&](double range_m) {
    const auto at = std::ranges::min_element(
        steady.range_m, {}, [&](double other_m) { return std::abs(other_m - range_m); });
    return steady.level_db.at(static_cast<std::size_t>(at - steady.range_m.begin()));
  };
  // A sum over strips, heights and frequencies by another program: -16.9 dB at 60 mm, -25.9 at 100.
  EXPECT_NEAR(level_db(100e-3) - level_db(60e-3), -9.0, 0.3);
  EXPECT_NEAR(steady.slope_db_per_cm, steady.expected_db_per_cm, 0.02);
  EXPECT_NEAR(
      measure_slope(Rung::field, true, inputs).slope_db_per_cm, steady.expected_db_per_cm, 0.07);
}

TEST(AttenuationStudy, BoneAndFluidChangeTheLevelBehindThem) {
  AttenuationInputs inputs;
  inputs.seeds = {1};
  inputs.sticks = inputs.frames = 8;
  const auto shadow = measure_bone_shadow(Rung::field, inputs);
  EXPECT_NEAR(shadow.expected_behind_db, -13.9, 0.3) << "by the same other program";
  EXPECT_NEAR(shadow.behind_db, shadow.expected_behind_db, 1);
  const auto enhancement = measure_cyst_enhancement(Rung::field, inputs);
  EXPECT_GT(enhancement.expected_behind_db, 8);
  EXPECT_LT(enhancement.expected_behind_db, 11) << "what the pulse alone would give";
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
  inputs.rungs = {Rung::geometry, Rung::field, Rung::scatterers};
  const auto results = measure_repeatability(inputs);
  ASSERT_EQ(results.size(), 6u);
  for (const auto& found : results) {
    EXPECT_EQ(found.runs, 4);
    EXPECT_EQ(found.differing, 0) << static_cast<int>(found.rung) << found.moving;
    if (found.rung == Rung::geometry) {
      EXPECT_EQ(found.other_seed, 0);
    } else {
      EXPECT_GT(found.other_seed, 0.5);
    }
  }
}

}  // namespace
}  // namespace wobblebench::bench
