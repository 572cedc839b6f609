#include "sim/rungs/stick_propagation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "base/units.h"
#include "phantoms/grids.h"
#include "phantoms/material.h"
#include "phantoms/phantom.h"
#include "sim/tissue/tissue_map.h"

namespace wobblebench::sim {
namespace {

const hw::AcquisitionPlan& plan() {
  static const hw::AcquisitionPlan shared({}, {});
  return shared;
}

/// Nothing but one material.
ScannedTissue uniform_tissue(const std::string& material) {
  const phantoms::Phantom phantom("even",
                                  phantoms::material_table(),
                                  phantoms::material_index(material),
                                  {},
                                  {glm::dvec3(-1), glm::dvec3(1)},
                                  glm::dvec3(0),
                                  std::make_shared<phantoms::Grids>());
  return {std::make_shared<const TissueMap>(phantom, 2e-3, 1), phantom.materials(), {}, {}};
}

TEST(HighestFrequency, OfEvenTissueIsThatOfAGaussianBand) {
  const FrequencyCourse course =
      highest_frequency(uniform_tissue("soft_tissue"), ProbeOptics(plan()), {});
  const double db_per_cm =
      phantoms::material("soft_tissue").attenuation_db_per_cm_mhz * 3.5;  // at the centre
  const double sigma = 0.6 / (2 * std::sqrt(2 * std::log(2.0)));          // over the centre
  for (const double range_m : {20e-3, 60e-3, 100e-3}) {
    const double nepers = 2 * db_per_cm * range_m * 1e2 * std::log(10.0) / 20;
    EXPECT_NEAR(course.at(range_m), 1 - nepers * sigma * sigma, 2e-3) << range_m;
  }
}

TEST(HighestFrequency, IsTheOneSentWhereNothingAbsorbs) {
  SimulationOptions lossless;
  lossless.attenuation = false;
  EXPECT_EQ(highest_frequency(uniform_tissue("soft_tissue"), ProbeOptics(plan()), lossless).at(0.1),
            1);
  EXPECT_EQ(FrequencyCourse{}.at(0.1), 1);
}

/// Sticks beside a ball of tissue in fluid keep what those through it lose.
TEST(HighestFrequency, IsThatOfTheSticksThatLoseLeast) {
  const auto ball = phantoms::make_phantom({.name = "sphere", .voxel_m = 1e-3});
  const ScannedTissue tissue{std::make_shared<const TissueMap>(ball, 2e-3, 1),
                             ball.materials(),
                             {glm::dmat3(1.0), ball.suggested_position_m()},
                             {}};
  const double here = highest_frequency(tissue, ProbeOptics(plan()), {}).at(0.12);
  EXPECT_NEAR(here,
              highest_frequency(uniform_tissue("amniotic_fluid"), ProbeOptics(plan()), {}).at(0.12),
              1e-3);
  EXPECT_GT(
      here,
      highest_frequency(uniform_tissue("soft_tissue"), ProbeOptics(plan()), {}).at(0.12) + 0.1);
}

/// Sound enters skin at less than 73 degrees: at a ball's rim a zone narrower than the beam
/// reflects totally, where the beam beside it enters.
TEST(StickPropagation, NoStickIsBlackBesideItsNeighbours) {
  const auto ball = phantoms::make_phantom({.name = "sphere", .radius_m = 20e-3});
  auto materials = ball.materials();
  materials[static_cast<std::size_t>(ball.surfaces().front().inside)] =
      phantoms::material("fetal_skin");
  const ScannedTissue tissue{std::make_shared<const TissueMap>(ball, 2e-3, 1),
                             materials,
                             {glm::dmat3(1.0), ball.suggested_position_m()},
                             {}};
  const hw::AcquisitionPlan dense({},
                                  {.sector_rad = 30 * kDegree,
                                   .fan_rad = 30 * kDegree,
                                   .sticks_per_frame = 60,
                                   .frames_per_volume = 9});  // lines about 1 mm apart at the ball
  SimulationOptions options;
  options.attenuation = false;
  options.noise_db = kZeroAmplitude_db;
  options.output = hw::SampleScale::linear_envelope;
  StickPropagation propagation(tissue, ProbeOptics(dense), options, Surfaces::crossed);
  for (std::uint32_t frame = 0; frame < 9; ++frame) {
    std::vector<std::vector<float>> remaining;
    for (std::uint32_t line = 0; line < 60; ++line) {
      propagation.follow({0, frame, line});
      remaining.push_back(propagation.losses().remaining());
    }
    for (std::size_t line = 1; line + 1 < remaining.size(); ++line) {
      for (double range_m = 40e-3; range_m < 110e-3; range_m += 1e-3) {
        const auto db = [&](std::size_t of) {
          const auto sample = static_cast<std::size_t>(range_m / propagation.spacing_m());
          const auto& stick = remaining[of];
          return sample < stick.size() ? 20 * std::log10(static_cast<double>(stick[sample])) : -200;
        };
        EXPECT_GT(db(line), std::min(db(line - 1), db(line + 1)) - 10)
            << frame << " " << line << " " << range_m;
      }
    }
  }
}

}  // namespace
}  // namespace wobblebench::sim
