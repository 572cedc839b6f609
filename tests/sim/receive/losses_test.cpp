#include "sim/receive/losses.h"

#include <gtest/gtest.h>

#include <cmath>

namespace wobblebench::sim {
namespace {

using phantoms::Material;
using phantoms::material;

constexpr int kCount = 1000;
constexpr double kSpacing_m = 0.1e-3;
constexpr double kDepth_m = kCount * kSpacing_m;

const hw::AcquisitionPlan& plan() {
  static const hw::AcquisitionPlan default_plan({}, {});
  return default_plan;
}

double db(double amplitude) {
  return 20 * std::log10(amplitude);
}

/// No echo is so weak that it is left out.
SimulationOptions no_threshold() {
  SimulationOptions options;
  options.noise_db = kZeroAmplitude_db;
  options.output = hw::SampleScale::linear_envelope;
  return options;
}

StickTrack one_material() {
  StickTrack track;
  track.stretches = {{0, kDepth_m, 0}};
  return track;
}

StickTrack two_materials(double at_m, double cos_incidence = 1) {
  StickTrack track;
  track.stretches = {{0, at_m, 0}, {at_m, kDepth_m, 1}};
  track.interfaces = {{at_m, 0, 1, cos_incidence}};
  return track;
}

StickLosses losses_of(const StickTrack& track,
                      const std::vector<Material>& materials,
                      const SimulationOptions& options) {
  StickLosses losses(plan(), options, materials, kSpacing_m, kCount);
  losses.compute(track);
  return losses;
}

TEST(Losses, ReflectionOfKnownPairs) {
  EXPECT_NEAR(reflection(material("amniotic_fluid"), material("fetal_skin"), 1), 0.0443, 1e-4);
  EXPECT_NEAR(reflection(material("muscle"), material("fetal_skull"), 1), 0.4516, 1e-4);
  EXPECT_EQ(reflection(material("muscle"), material("muscle"), 1), 0);
  EXPECT_NEAR(reflection(material("muscle"), material("muscle"), 0.3), 0, 1e-15);
}

TEST(Losses, ReflectionDependsOnTheAngle) {
  // Water to bone, 20 degrees, by hand: sin t = 2500 / 1480 sin 20, cos t = 0.816222.
  const double expected = (4.5 * std::cos(20 * kDegree) - 1.48 * 0.816222) /
                          (4.5 * std::cos(20 * kDegree) + 1.48 * 0.816222);
  const Material& water = material("water");
  const Material& bone = material("fetal_skull");
  EXPECT_NEAR(reflection(water, bone, std::cos(20 * kDegree)), expected, 1e-5);
  const double critical = std::asin(1480.0 / 2500.0);
  EXPECT_LT(reflection(water, bone, std::cos(critical - 1e-3)), 1);
  EXPECT_EQ(reflection(water, bone, std::cos(critical + 1e-3)), 1) << "total reflection";
  EXPECT_EQ(std::abs(reflection(water, material("fat"), 0)), 1) << "grazing";
}

TEST(Losses, EnergyIsReciprocalAtAnyAngle) {
  // R and T of both directions of one refracted path: r12 = -r21.
  const Material& a = material("fat");
  const Material& b = material("muscle");
  for (double angle_deg : {0.0, 10.0, 30.0, 50.0}) {
    const double sine = std::sin(angle_deg * kDegree) * b.sound_speed_m_s / a.sound_speed_m_s;
    const double forth = reflection(a, b, std::cos(angle_deg * kDegree));
    const double back = reflection(b, a, std::sqrt(1 - sine * sine));
    EXPECT_NEAR(forth, -back, 1e-12);
  }
}

TEST(Losses, AttenuationIsTwiceAlphaTimesFrequency) {
  const auto losses = losses_of(one_material(), {material("soft_tissue")}, no_threshold());
  const auto& remaining = losses.remaining();
  ASSERT_EQ(remaining.size(), static_cast<std::size_t>(kCount));
  // 0.5 dB/cm/MHz, 3.5 MHz, both ways: 3.5 dB a centimetre, 100 samples.
  for (std::size_t i = 0; i + 100 < remaining.size(); i += 37) {
    EXPECT_NEAR(db(static_cast<double>(remaining[i] / remaining[i + 100])), 3.5, 1e-3);
  }
  EXPECT_NEAR(db(static_cast<double>(remaining[0])), -3.5 * 0.5 * kSpacing_m / 1e-2, 1e-6);
}

TEST(Losses, InterfaceReflectionIsLostBothWays) {
  const std::vector<Material> materials = {material("water"), material("fetal_skull")};
  auto options = no_threshold();
  options.attenuation = false;
  const auto losses = losses_of(two_materials(400 * kSpacing_m), materials, options);
  const double r = (4.5 - 1.48) / (4.5 + 1.48);
  EXPECT_EQ(losses.remaining()[399], 1.0f);
  EXPECT_NEAR(losses.remaining()[400], 1 - r * r, 1e-6);
  EXPECT_EQ(losses.remaining()[999], losses.remaining()[400]);
  EXPECT_EQ(losses.at_interface()[0], 1);
  options.transmission_loss = false;
  EXPECT_EQ(losses_of(two_materials(400 * kSpacing_m), materials, options).remaining()[999], 1.0f);
}

TEST(Losses, EndsWhereEchoesAreInvisible) {
  const std::vector<Material> materials = {material("water"), material("fetal_skull")};
  SimulationOptions options;
  const auto losses = losses_of(two_materials(10e-3), materials, options);
  ASSERT_LT(losses.remaining().size(), static_cast<std::size_t>(kCount));
  EXPECT_NEAR(db(static_cast<double>(losses.remaining().back())), options.noise_db - 20, 0.5);
  // Beyond the critical angle nothing enters.
  const auto grazing = losses_of(two_materials(10e-3, 0.1), materials, options);
  EXPECT_EQ(grazing.remaining().size(), 100u);
}

TEST(Losses, SoundSpeedShiftsApparentRanges) {
  const std::vector<Material> materials = {material("fat"), material("muscle")};
  auto options = no_threshold();
  options.tissue_sound_speed = true;
  const auto track = two_materials(40e-3);
  const auto losses = losses_of(track, materials, options);
  const double behind_fat_m = 40e-3 * 1540 / 1450;
  EXPECT_NEAR(losses.apparent_m(track, 40e-3), behind_fat_m, 1e-12);
  EXPECT_NEAR(losses.apparent_m(track, 60e-3), behind_fat_m + 20e-3 * 1540 / 1580, 1e-12);
  for (int i = 0; i < kCount; i += 99) {
    const double apparent_m = (i + 0.5) * kSpacing_m;
    const double true_m =
        apparent_m - static_cast<double>(losses.delay_m().at(static_cast<std::size_t>(i)));
    EXPECT_NEAR(losses.apparent_m(track, true_m), apparent_m, 1e-8);
  }
}

TEST(Losses, SpecularLobeHasItsWidthAndDiffuseEchoFollowsTheCosine) {
  Material before = material("amniotic_fluid"), behind = material("fetal_skin");
  before.roughness = behind.roughness = 0;
  SimulationOptions options;
  const auto specular = [&](double angle_rad) {
    return specular_echo(before, behind, std::cos(angle_rad), options);
  };
  const double r = reflection(before, behind, 1);
  EXPECT_NEAR(specular(0), r, 1e-12);
  EXPECT_NEAR(db(specular(options.specular_width_rad / 2) / r), -3.01, 0.01);
  EXPECT_LT(specular(10 * kDegree), 1e-3 * r);
  EXPECT_EQ(diffuse_echo(before, behind, 1), 0);
  behind.roughness = 1;
  EXPECT_NEAR(
      diffuse_echo(before, behind, 0.5), 0.5 * std::abs(reflection(before, behind, 0.5)), 1e-12);
  EXPECT_EQ(specular(0), 0);
}

TEST(Losses, TimeGainCompensatesItsNominalTissue) {
  auto options = no_threshold();
  options.tgc_db_per_cm_mhz = material("soft_tissue").attenuation_db_per_cm_mhz;
  const auto losses = losses_of(one_material(), {material("soft_tissue")}, options);
  for (int i = 0; i < kCount; i += 111) {
    const double gained = static_cast<double>(losses.remaining()[static_cast<std::size_t>(i)]) *
                          time_gain(plan(), options, (i + 0.5) * kSpacing_m);
    EXPECT_NEAR(db(gained), 0, 1e-3);
  }
}

}  // namespace
}  // namespace wobblebench::sim
