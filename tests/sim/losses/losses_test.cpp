#include "sim/losses/losses.h"
#include "sim/losses/stick_losses.h"
#include "sim/receive/receiver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace wobblebench::sim {
namespace {

using phantoms::Material;
using phantoms::material;

constexpr int kCount = 1000;
constexpr double kSpacing_m = 0.1e-3;
constexpr double kStickDepth_m = kCount * kSpacing_m;

const hw::AcquisitionPlan& losses_plan() {
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
  track.stretches = {{0, kStickDepth_m, 0}};
  return track;
}

StickTrack two_materials(double at_m, double cos_incidence = 1) {
  StickTrack track;
  track.stretches = {{0, at_m, 0}, {at_m, kStickDepth_m, 1}};
  track.interfaces = {{at_m, 0, 1, cos_incidence}};
  return track;
}

StickLosses losses_of(const StickTrack& track,
                      const std::vector<Material>& materials,
                      const SimulationOptions& options) {
  StickLosses losses(losses_plan(), options, materials, kSpacing_m, kCount);
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

/// A Gaussian amplitude spectrum, -6 dB at the edges of the default band and nothing below
/// `lowest`, after a loss of this number of nepers at the centre frequency that grows in proportion
/// to frequency. Summed over frequency.
struct Received {
  double amplitude = 0;  ///< of the echo's peak, over that without loss
  double frequency = 0;  ///< centre of the spectrum, over that without loss
};

Received received(double nepers, double lowest = 0.2) {
  const double half = losses_plan().probe().fractional_bandwidth / 2;
  double sum = 0, first = 0, sent = 0;
  for (int i = 0; i <= 5000; ++i) {
    const double f = lowest + 1e-3 * (i + 0.5);
    const double before = std::pow(0.5, (f - 1) * (f - 1) / (half * half));
    const double after = before * std::exp(-nepers * f);
    sent += before;
    sum += after;
    first += f * after;
  }
  return {sum / sent, first / sum};
}

/// Two-way nepers at the centre frequency behind a distance in a material, one speed of sound.
double nepers(const Material& material, double distance_m) {
  const double db = 2 * material.attenuation_db_per_cm_mhz * 3.5 * distance_m / 1e-2;
  return db / 20 * std::log(10.0);
}

TEST(Losses, AttenuationIsThatOfTheWholeBand) {
  const Material& tissue = material("soft_tissue");
  const auto losses = losses_of(one_material(), {tissue}, no_threshold());
  const auto& remaining = losses.remaining();
  ASSERT_EQ(remaining.size(), static_cast<std::size_t>(kCount));
  ASSERT_EQ(losses.frequency_ratio().size(), remaining.size());
  for (std::size_t i = 0; i < remaining.size(); i += 37) {
    const auto at = received(nepers(tissue, (static_cast<double>(i) + 0.5) * kSpacing_m));
    EXPECT_NEAR(db(static_cast<double>(remaining[i])), db(at.amplitude), 2e-3) << i;
    const auto whole = received(nepers(tissue, (static_cast<double>(i) + 0.5) * kSpacing_m), -3);
    EXPECT_NEAR(losses.frequency_ratio()[i], whole.frequency, 5e-5) << i;
  }
  // Issue 6: from 3.5 to 2.6 MHz in 10 cm.
  EXPECT_NEAR(3.5 * static_cast<double>(losses.frequency_ratio().back()), 2.58, 0.01);
}

TEST(Losses, ABandsLossesAddUpOverMaterials) {
  const std::vector<Material> materials = {material("fat"), material("muscle")};
  auto options = no_threshold();
  options.transmission_loss = false;
  const auto losses = losses_of(two_materials(30e-3), materials, options);
  const double both = nepers(materials[0], 30e-3) + nepers(materials[1], 20e-3);
  const auto at = received(both);
  EXPECT_NEAR(db(static_cast<double>(losses.remaining()[500])), db(at.amplitude), 0.05);
  EXPECT_NEAR(losses.frequency_ratio()[500], received(both, -3).frequency, 1e-3);
}

/// A Gaussian spectrum has energy at any low frequency, a transducer's has not.
TEST(Losses, BelowAFifthOfTheFrequencyNothingIsLeft) {
  const Material& bone = material("cortical_bone");
  const auto losses = losses_of(one_material(), {bone}, no_threshold());
  const auto& remaining = losses.remaining();
  for (std::size_t i = 0; i < 700; i += 23) {
    const double lost = nepers(bone, (static_cast<double>(i) + 0.5) * kSpacing_m);
    EXPECT_NEAR(db(static_cast<double>(remaining[i])), db(received(lost).amplitude), 0.02) << i;
  }
  // At last the level falls at the rate of the lowest frequencies.
  const double step = nepers(bone, kSpacing_m);
  const double last = std::log(static_cast<double>(remaining[999] / remaining[998]));
  EXPECT_LT(last, -0.2 * step);
  EXPECT_GT(last, -0.27 * step);
}

TEST(Losses, WithoutAbsorptionThePulseKeepsItsFrequency) {
  auto options = no_threshold();
  options.attenuation = false;
  EXPECT_TRUE(losses_of(one_material(), {material("fat")}, options).frequency_ratio().empty());
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
}

TEST(Losses, BeyondTheCriticalAngleNothingVisibleEnters) {
  const std::vector<Material> materials = {material("water"), material("fetal_skull")};
  for (const bool sees_all : {false, true}) {
    const auto options = sees_all ? no_threshold() : SimulationOptions();
    const auto grazing = losses_of(two_materials(10e-3, 0.1), materials, options);
    EXPECT_EQ(grazing.visible_samples(), 100);
    // What the interface's own echo is measured against, 4 mm behind it.
    ASSERT_EQ(grazing.remaining().size(), 140u);
    for (std::size_t i = 100; i < 140; ++i) {
      EXPECT_LT(grazing.remaining()[i], 2e-7f);
      EXPECT_GT(grazing.remaining()[i], 0.0f);
    }
  }
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

/// What is left is the gain of the band: low frequencies lose less than the centre's.
TEST(Losses, TimeGainCompensatesTheCentreFrequency) {
  auto options = no_threshold();
  const Material& tissue = material("soft_tissue");
  options.tgc_db_per_cm_mhz = tissue.attenuation_db_per_cm_mhz;
  const auto losses = losses_of(one_material(), {tissue}, options);
  for (int i = 0; i < kCount; i += 111) {
    const double range_m = (i + 0.5) * kSpacing_m, lost = nepers(tissue, range_m);
    const double gained = static_cast<double>(losses.remaining()[static_cast<std::size_t>(i)]) *
                          time_gain(losses_plan(), options, range_m);
    EXPECT_NEAR(db(gained), db(received(lost).amplitude * std::exp(lost)), 2e-3);
  }
}

/// Nodes of range at which the paths beside the axis are brighter.
TEST(Losses, TheAperturesCorrectionIsInterpolatedBetweenNodes) {
  auto options = no_threshold();
  options.attenuation = false;
  const std::vector<Material> materials = {material("water"), material("fetal_skull")};
  const auto track = two_materials(10e-3, 0.1);  // total reflection
  const std::vector<float> log_gain = {0, 0, 8, 10, 10}, frequency(5, 0);
  StickLosses losses(losses_plan(), options, materials, kSpacing_m, kCount);
  losses.compute(track, {25e-3, log_gain, frequency});
  ASSERT_EQ(losses.remaining().size(), static_cast<std::size_t>(kCount));
  EXPECT_EQ(losses.visible_samples(), kCount);
  for (int i = 0; i < kCount; i += 7) {
    const double node = (i + 0.5) * kSpacing_m / 25e-3;
    const auto before = std::min(static_cast<std::size_t>(node), std::size_t{3});
    const double share = node - static_cast<double>(before);
    const double gain = (1 - share) * static_cast<double>(log_gain[before]) +
                        share * static_cast<double>(log_gain[before + 1]);
    const double expected = i < 100 ? 1 : 1e-7 * std::exp(gain);
    EXPECT_NEAR(losses.remaining()[static_cast<std::size_t>(i)], expected, 1e-5 * expected) << i;
  }
}

}  // namespace
}  // namespace wobblebench::sim
