#include "sim/losses.h"

#include <gtest/gtest.h>

#include <cmath>

namespace wobblebench::sim {
namespace {

using phantoms::material;

constexpr int kCount = 1000;
constexpr double kSpacing_m = 0.1e-3;

const hw::AcquisitionPlan& plan() {
  static const hw::AcquisitionPlan default_plan({}, {});
  return default_plan;
}

double db(double amplitude) {
  return 20 * std::log10(amplitude);
}

TEST(Losses, ReflectionOfKnownPairs) {
  EXPECT_NEAR(reflection(material("amniotic_fluid"), material("fetal_skin")), 0.0443, 1e-4);
  EXPECT_NEAR(reflection(material("muscle"), material("fetal_skull")), 0.4516, 1e-4);
  EXPECT_EQ(reflection(material("muscle"), material("muscle")), 0);
}

TEST(Losses, AttenuationIsTwiceAlphaTimesFrequency) {
  const std::vector<phantoms::Material> materials = {material("soft_tissue")};
  const TissueProfile profile{{{0, kCount, 0}}, {}};
  const auto amplitude = two_way_amplitude(profile, materials, plan(), {}, kSpacing_m, kCount);
  // 0.5 dB/cm/MHz, 3.5 MHz, both ways: 3.5 dB a centimetre, 100 samples.
  for (std::size_t i = 0; i + 100 < amplitude.size(); i += 37) {
    EXPECT_NEAR(db(static_cast<double>(amplitude[i] / amplitude[i + 100])), 3.5, 1e-3);
  }
}

TEST(Losses, InterfaceTakesWhatItReflectsBothWays) {
  const std::vector<phantoms::Material> materials = {material("water"), material("fetal_skull")};
  const TissueProfile profile{{{0, 400, 0}, {400, kCount, 1}}, {{400 * kSpacing_m, 0, 1, 1.0}}};
  SimulationOptions options;
  options.attenuation = false;
  const auto amplitude = two_way_amplitude(profile, materials, plan(), options, kSpacing_m, kCount);
  const double r = (4.5 - 1.48) / (4.5 + 1.48);
  EXPECT_EQ(amplitude[399], 1.0f);
  EXPECT_NEAR(amplitude[400], 1 - r * r, 1e-6);
  EXPECT_EQ(amplitude[999], amplitude[400]);
  options.transmission_loss = false;
  EXPECT_EQ(two_way_amplitude(profile, materials, plan(), options, kSpacing_m, kCount)[999], 1.0f);
}

TEST(Losses, SpecularLobeHasItsWidthAndRoughnessItsFloor) {
  std::vector<phantoms::Material> materials = {material("amniotic_fluid"), material("fetal_skin")};
  for (auto& m : materials) m.roughness = 0;
  SimulationOptions options;
  const double r = reflection(materials[0], materials[1]);
  const auto echo = [&](double angle_rad) {
    return interface_echo({0, 0, 1, std::cos(angle_rad)}, materials, options);
  };
  EXPECT_NEAR(echo(0).specular, r, 1e-12);
  EXPECT_NEAR(db(echo(options.specular_width_rad / 2).specular / r), -3.01, 0.01);
  EXPECT_LT(echo(10 * kDegree).specular, 1e-3 * r);
  EXPECT_EQ(echo(0).diffuse, 0);
  for (auto& m : materials) m.roughness = 1;
  EXPECT_NEAR(echo(60 * kDegree).diffuse, 0.5 * r, 1e-12);
  EXPECT_EQ(echo(0).specular, 0);
}

TEST(Losses, TimeGainUndoesItsNominalTissue) {
  std::vector<phantoms::Material> materials = {material("soft_tissue")};
  SimulationOptions options;
  options.tgc_db_per_cm_mhz = materials[0].attenuation_db_per_cm_mhz;
  const TissueProfile profile{{{0, kCount, 0}}, {}};
  const auto amplitude = two_way_amplitude(profile, materials, plan(), options, kSpacing_m, kCount);
  for (int i = 0; i < kCount; i += 111) {
    const double gained = static_cast<double>(amplitude[static_cast<std::size_t>(i)]) *
                          time_gain(plan(), options, i * kSpacing_m);
    EXPECT_NEAR(db(gained), 0, 1e-3);
  }
}

}  // namespace
}  // namespace wobblebench::sim
