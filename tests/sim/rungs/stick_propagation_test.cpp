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

const hw::AcquisitionPlan& propagation_plan() {
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
      highest_frequency(uniform_tissue("soft_tissue"), ProbeOptics(propagation_plan()), {});
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
  EXPECT_EQ(
      highest_frequency(uniform_tissue("soft_tissue"), ProbeOptics(propagation_plan()), lossless)
          .at(0.1),
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
  const double here = highest_frequency(tissue, ProbeOptics(propagation_plan()), {}).at(0.12);
  EXPECT_NEAR(
      here,
      highest_frequency(uniform_tissue("amniotic_fluid"), ProbeOptics(propagation_plan()), {})
          .at(0.12),
      1e-3);
  EXPECT_GT(here,
            highest_frequency(uniform_tissue("soft_tissue"), ProbeOptics(propagation_plan()), {})
                    .at(0.12) +
                0.1);
}

/// Level along each stick of a frame, and its interfaces.
struct TracedFrame {
  std::vector<std::vector<float>> remaining;
  std::vector<StickTrack> tracks;
  double spacing_m = 0;

  double db(std::size_t line, double range_m) const {
    const auto& levels = remaining[line];
    const auto sample = static_cast<std::size_t>(range_m / spacing_m);
    return sample < levels.size() ? 20 * std::log10(static_cast<double>(levels[sample])) : -200;
  }
  /// The material at a range; -1 within 1 mm of an interface.
  int material_around(std::size_t line, double range_m) const {
    for (const Stretch& stretch : tracks[line].stretches) {
      if (stretch.from_m + 1e-3 < range_m && range_m < stretch.to_m - 1e-3) return stretch.material;
    }
    return -1;
  }
  /// True if a stick lies 10 dB below both neighbours, both above -40 dB and in the same material.
  bool has_slit(std::size_t line, double depth_m) const {
    for (double range_m = 20e-3; range_m < depth_m - 1e-3; range_m += 1e-3) {
      const int here = material_around(line, range_m);
      if (here < 0 || here != material_around(line - 1, range_m) ||
          here != material_around(line + 1, range_m)) {
        continue;
      }
      const double darker_db = std::min(db(line - 1, range_m), db(line + 1, range_m));
      if (darker_db > -40 && db(line, range_m) < darker_db - 10) return true;
    }
    return false;
  }
};

/// Sticks with a slit (TracedFrame::has_slit()) in a volume, by losses at interfaces alone.
int count_slits(const ScannedTissue& tissue, const hw::AcquisitionPlan& plan) {
  SimulationOptions options;
  options.attenuation = false;
  options.noise_db = kZeroAmplitude_db;
  options.output = hw::SampleScale::linear_envelope;
  StickPropagation propagation(tissue, ProbeOptics(plan), options, Surfaces::crossed);
  const auto& acquisition = plan.acquisition();
  const auto frames = static_cast<std::uint32_t>(acquisition.frames_per_volume);
  const auto lines = static_cast<std::uint32_t>(acquisition.sticks_per_frame);
  int slits = 0;
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    TracedFrame traced{{}, {}, propagation.spacing_m()};
    for (std::uint32_t line = 0; line < lines; ++line) {
      propagation.follow({0, frame, line});
      traced.remaining.push_back(propagation.losses().remaining());
      traced.tracks.push_back(propagation.track());
    }
    for (std::uint32_t line = 1; line + 1 < lines; ++line) {
      slits += traced.has_slit(line, acquisition.depth_m) ? 1 : 0;
    }
  }
  return slits;
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
  EXPECT_EQ(count_slits(tissue, dense), 0);
}

/// Sound enters bone at less than 38 degrees: behind the skull, totally reflecting zones are as
/// small as its relief.
TEST(StickPropagation, FewSticksAreBlackInTheHead) {
  const auto face = phantoms::make_phantom({.name = "fetal_face"});
  const ScannedTissue tissue{std::make_shared<const TissueMap>(face, 2e-3, 1),
                             face.materials(),
                             {glm::dmat3(1.0), face.suggested_position_m()},
                             {}};
  EXPECT_LE(count_slits(tissue, propagation_plan()), 5);
  const hw::AcquisitionPlan dense({}, {.sticks_per_frame = 128, .frames_per_volume = 97});
  EXPECT_LE(count_slits(tissue, dense), 5);
  const hw::AcquisitionPlan fine({},  // docs/scenes/face_fine.toml
                                 {.sector_rad = 60 * kDegree,
                                  .fan_rad = 50 * kDegree,
                                  .sticks_per_frame = 128,
                                  .frames_per_volume = 97});
  EXPECT_EQ(count_slits(tissue, fine), 0);
}

}  // namespace
}  // namespace wobblebench::sim
