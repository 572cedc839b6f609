// Clutter against closed forms: repeated echoes, the floor beside and behind tissue, particles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>

#include "phantoms/grids.h"
#include "sim/clutter/particles.h"
#include "sim/math/smooth_noise.h"
#include "sim/probe_simulator.h"

namespace wobblebench::sim {
namespace {

/// Linear envelopes without noise and losses.
SimulationOptions bare(std::uint64_t seed = 1) {
  SimulationOptions options;
  options.fidelity = Rung::field;
  options.seed = seed;
  options.attenuation = false;
  options.transmission_loss = false;
  options.noise_db = kZeroAmplitude_db;
  options.tgc_db_per_cm_mhz = 0;
  options.full_scale_db = 0;
  options.low_pass = false;
  options.output = hw::SampleScale::linear_envelope;
  return options;
}

hw::AcquisitionPlan plan_of(int sticks, int frames) {
  return {{},
          {.depth_m = 0.12,
           .sticks_per_frame = sticks,
           .samples_per_stick = 1024,
           .frames_per_volume = frames}};
}

/// The same phantom with other materials.
phantoms::Phantom with_materials(const phantoms::Phantom& phantom,
                                 std::vector<phantoms::Material> materials) {
  const auto owner = std::make_shared<const phantoms::Phantom>(phantom);
  return {phantom.name(),
          std::move(materials),
          phantom.background(),
          phantom.surfaces(),
          phantom.region_of_interest(),
          phantom.suggested_position_m(),
          {owner, &owner->grids()}};
}

phantoms::Phantom open_tissue() {
  return {"open",
          phantoms::material_table(),
          phantoms::material_index("soft_tissue"),
          {},
          {glm::dvec3(-1), glm::dvec3(1)},
          glm::dvec3(0),
          std::make_shared<phantoms::Grids>()};
}

/// Root of the energy about a range: of a pulse, in proportion to its peak wherever it lies between
/// samples.
double amplitude_near(const std::vector<float>& stick,
                      const hw::AcquisitionPlan& plan,
                      double at_m) {
  double energy = 0;
  for (int k = 0; k < plan.acquisition().samples_per_stick; ++k) {
    if (std::abs(plan.sample_range_m(k) - at_m) > 1e-3) continue;
    const auto sample = static_cast<double>(stick[static_cast<std::size_t>(k)]);
    energy += sample * sample;
  }
  return std::sqrt(energy);
}

/// A mirror at 30 mm is seen again at 60 and at 90 mm: R, p R^2, p^2 R^3.
TEST(Reverberation, RepeatsAMirrorAtMultiplesOfItsRange) {
  const auto plane = phantoms::make_phantom({.name = "plane", .voxel_m = 2e-3});
  auto materials = plane.materials();
  for (auto& material : materials) {
    if (material.name == "soft_tissue") material.impedance_rayl = 3 * 1.51e6;
    if (material.name == "soft_tissue") material.sound_speed_m_s = 1530;
    material.backscatter_db = kZeroAmplitude_db;
    material.roughness = 0;
  }
  constexpr double kMirror = 0.5, kFace = 0.4;  // (3 - 1) / (3 + 1)
  const auto plan = plan_of(1, 1);
  const double face_m = plan.probe().radius_m;
  // The plane passes through the phantom's origin.
  for (const double range_m : {30e-3, 30.07e-3}) {
    auto options = bare();
    options.clutter.probe_reflection = kFace;
    const ProbeSimulator simulator(
        phantoms::still_at(with_materials(plane, materials), {0, 0, face_m + range_m}),
        plan,
        options);
    const auto stick = simulator.volume(0);
    const double first = amplitude_near(stick, plan, range_m);
    EXPECT_NEAR(amplitude_near(stick, plan, 2 * range_m) / first, kFace * kMirror, 0.01 * 0.2);
    EXPECT_NEAR(amplitude_near(stick, plan, 3 * range_m) / first, 0.2 * 0.2, 0.02 * 0.04);
    EXPECT_LT(amplitude_near(stick, plan, 1.5 * range_m), 1e-4 * first);
  }
}

double mean_power(const std::vector<float>& samples, int each, int from, int to) {
  double sum = 0;
  long count = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const int k = static_cast<int>(i) % each;
    if (k < from || k >= to) continue;
    sum += static_cast<double>(samples[i]) * static_cast<double>(samples[i]);
    ++count;
  }
  return sum / static_cast<double>(count);
}

/// In uniform tissue, many trails behind the face, the haze has the level that the option names.
/// In a narrow sector, where every stick has its whole aperture.
TEST(Haze, OfUniformTissueHasItsLevel) {
  const hw::AcquisitionPlan plan({},
                                 {.depth_m = 0.12,
                                  .sector_rad = 0.35,
                                  .sticks_per_frame = 24,
                                  .samples_per_stick = 1024,
                                  .frames_per_volume = 24});
  const auto subject = phantoms::still_at(open_tissue(), glm::dvec3(0));
  const double clean = mean_power(ProbeSimulator(subject, plan, bare()).volume(0), 1024, 700, 1024);
  for (const double level_db : {0.0, 6.0}) {
    auto options = bare();
    options.clutter.haze_db = level_db;
    const double hazy =
        mean_power(ProbeSimulator(subject, plan, options).volume(0), 1024, 700, 1024);
    EXPECT_NEAR(hazy / clean, 1 + std::pow(10, level_db / 10), 0.06 * (hazy / clean)) << level_db;
  }
}

/// On a single stick there is nothing beside: behind 40 mm of tissue the haze dies away as
/// exp(-r / trail).
TEST(Haze, TrailsBehindTissue) {
  const auto ball = phantoms::make_phantom({.name = "sphere", .voxel_m = 1e-3});
  const auto plan = plan_of(1, 1);
  const auto subject = phantoms::still_at(ball, {0, 0, plan.probe().radius_m + 50e-3});
  std::shared_ptr<const TissueMap> kept;
  const TissueMapSource maps = [&](const phantoms::Phantom& phantom, double reach_m, int threads) {
    if (kept == nullptr) kept = std::make_shared<const TissueMap>(phantom, reach_m, threads);
    return kept;
  };
  constexpr double kTrail_m = 10e-3;
  std::vector<float> all;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    auto options = bare(seed);
    options.interface_echo = false;
    options.clutter.haze_db = 0;
    options.clutter.haze_trail_m = kTrail_m;
    const auto stick = ProbeSimulator(subject, plan, options, maps).volume(0);
    all.insert(all.end(), stick.begin(), stick.end());
  }
  // Ball from 30 to 70 mm. Samples are 0.117 mm apart.
  const auto power_at = [&](double range_m) {
    const int middle = static_cast<int>(range_m / 0.12 * 1024);
    return mean_power(all, 1024, middle - 8, middle + 8);
  };
  const double tissue = std::pow(10, -45.0 / 10) * 4 / kPi;
  EXPECT_NEAR(power_at(80e-3) / tissue, (1 - std::exp(-4)) * std::exp(-1), 0.12 * std::exp(-1));
  EXPECT_NEAR(power_at(90e-3) / tissue, (1 - std::exp(-4)) * std::exp(-2), 0.12 * std::exp(-2));
  EXPECT_LT(power_at(20e-3) / tissue, 1e-6);
}

/// Nothing echoes, so nothing makes haze.
TEST(Haze, OfFluidIsNone) {
  const phantoms::Phantom fluid{"open",
                                phantoms::material_table(),
                                phantoms::material_index("amniotic_fluid"),
                                {},
                                {glm::dvec3(-1), glm::dvec3(1)},
                                glm::dvec3(0),
                                std::make_shared<phantoms::Grids>()};
  auto options = bare();
  options.clutter.haze_db = 10;
  options.clutter.probe_reflection = 0.5;
  const auto samples =
      ProbeSimulator(phantoms::still_at(fluid, glm::dvec3(0)), plan_of(8, 4), options).volume(0);
  EXPECT_EQ(*std::max_element(samples.begin(), samples.end()), 0);
}

TEST(UnevenTissue, KeepsTheMeanPower) {
  const auto plan = plan_of(48, 24);
  const auto subject = phantoms::still_at(open_tissue(), glm::dvec3(0));
  double even = 0, uneven = 0;
  std::vector<double> blocks_db;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    auto options = bare(seed);
    even += mean_power(ProbeSimulator(subject, plan, options).volume(0), 1024, 0, 1024);
    options.clutter.tissue_unevenness_db = 4;
    options.clutter.tissue_grain_m = 20e-3;
    const auto samples = ProbeSimulator(subject, plan, options).volume(0);
    uneven += mean_power(samples, 1024, 0, 1024);
    // Blocks of 5 mm and 48 x 24 sticks' neighbours: 1 stick.
    for (std::size_t stick = 0; stick < std::size_t{48} * 24; stick += 5) {
      const std::vector<float> one(
          samples.begin() + static_cast<std::ptrdiff_t>(stick * 1024),
          samples.begin() + static_cast<std::ptrdiff_t>(stick * 1024 + 1024));
      blocks_db.push_back(10 * std::log10(mean_power(one, 1024, 500, 560)));
    }
  }
  EXPECT_NEAR(uneven / even, 1, 0.12);
  double mean = 0, square = 0;
  for (const double db : blocks_db) mean += db / static_cast<double>(blocks_db.size());
  for (const double db : blocks_db) square += (db - mean) * (db - mean);
  // 4 dB, and what is left of speckle in a mean over some 25 of its grains: about 1 dB.
  EXPECT_NEAR(std::sqrt(square / static_cast<double>(blocks_db.size())), 4.1, 0.6);
}

/// Behind fluid the factor's standard deviation in dB grows linearly to its full value, and its
/// mean power stays 1.
TEST(UnevenTissue, GrowsBelowTheSkin) {
  constexpr double kSigma_db = 8, kSkin_m = 12e-3;
  const auto plane = phantoms::make_phantom({.name = "plane", .voxel_m = 2e-3});
  const auto plan = plan_of(48, 24);
  const double plane_z_m = plan.probe().radius_m + 30e-3;
  const auto subject = phantoms::still_at(plane, {0, 0, plane_z_m});
  for (const double depth_m : {0.3e-3, 3e-3, 9e-3, 15e-3, 30e-3}) {
    double sum_db = 0, squares = 0;
    int count = 0;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      auto options = bare(seed);
      const auto even = ProbeSimulator(subject, plan, options).volume(0);
      options.clutter.tissue_unevenness_db = kSigma_db;
      options.clutter.tissue_grain_m = 4e-3;
      options.clutter.even_skin_m = kSkin_m;
      const auto uneven = ProbeSimulator(subject, plan, options).volume(0);
      for (int i = 0; i < plan.sticks_per_volume(); ++i) {
        const hw::Ray ray = stick_ray(plan, plan.index(static_cast<std::uint64_t>(i))).ray;
        const double range_m = (plane_z_m - ray.origin.z) / ray.direction.z + depth_m;
        const auto k = static_cast<int>(std::lround(range_m / plan.sample_spacing_m()));
        if (k >= plan.acquisition().samples_per_stick) continue;
        const auto at = static_cast<std::size_t>(i) * 1024 + static_cast<std::size_t>(k);
        if (even[at] == 0) continue;
        const double ratio = static_cast<double>(uneven[at]) / static_cast<double>(even[at]);
        const double db = 20 * std::log10(ratio);
        sum_db += db;
        squares += db * db;
        ++count;
      }
    }
    ASSERT_GT(count, 2000);
    const double sigma_db = kSigma_db * std::min(1.0, depth_m / kSkin_m);
    const double mean_db = sum_db / count;
    EXPECT_NEAR(std::sqrt(squares / count - mean_db * mean_db), sigma_db, 0.2 + 0.06 * sigma_db)
        << depth_m;
    // Of a log-normal amplitude whose mean square is 1; it is interpolated over half a grain.
    EXPECT_NEAR(mean_db, -sigma_db * sigma_db * std::log(10.0) / 20, 0.1 + 0.12 * sigma_db);
  }
}

TEST(SmoothNoise, HasUnitVarianceAndIsContinuous) {
  double sum = 0, squares = 0, apart = 0, step = 0;
  constexpr int kCount = 20000;
  for (int i = 0; i < kCount; ++i) {
    const glm::dvec3 at{1.37 * i - 9000, 0.711 * i, -0.513 * i};
    const double here = smooth_noise(7, at), near = smooth_noise(7, at + glm::dvec3(1e-3, 0, 0));
    sum += here;
    squares += here * here;
    apart += here * smooth_noise(7, at + glm::dvec3(2, 0, 0));
    step = std::max(step, std::abs(near - here));
  }
  EXPECT_NEAR(sum / kCount, 0, 0.03);
  EXPECT_NEAR(squares / kCount, 1, 0.04);
  EXPECT_NEAR(apart / kCount, 0, 0.03);
  EXPECT_LT(step, 0.02);
}

TEST(Particles, AreAsManyAsAskedForAndInFluidAlone) {
  const auto ball = phantoms::make_phantom({.name = "sphere", .voxel_m = 1e-3});
  const auto plan = plan_of(8, 4);
  const auto subject = phantoms::still_at(ball, {0, 0, 0.11});
  SimulationOptions options = bare();
  options.clutter.particles_per_cm3 = 2;
  options.clutter.particle_echo_db = -60;
  const TissueMap map(ball, 1e-3, 1);
  const auto particles = fluid_particles(subject, map, plan, options);
  double squares = 0;
  std::size_t within = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const auto point = particles.at(i, 0);
    EXPECT_GT(glm::length(point.position_m), 20e-3 - 0.1e-3);  // the ball's radius
    within += glm::length(point.position_m) < 40e-3 ? 1 : 0;
    squares += point.amplitude * point.amplitude;
  }
  // Between the ball and twice its radius: 4/3 pi (64 - 8) cm3.
  const double expected = 2 * 4.0 / 3 * kPi * (64 - 8);
  EXPECT_NEAR(static_cast<double>(within), expected, 4 * std::sqrt(expected));
  EXPECT_NEAR(10 * std::log10(squares / static_cast<double>(particles.size())), -60, 0.3);
}

/// Clutter of every kind, with motion: neither threads nor the way sticks are asked for matter.
TEST(Clutter, IsAFunctionOfTheSeed) {
  const auto ball = phantoms::make_phantom({.name = "sphere", .voxel_m = 1e-3});
  auto subject = phantoms::still_at(ball, {0, 0, 0.11});
  subject.motion = phantoms::Motion({.velocity_m_s = {5e-3, 0, 2e-3}}, ball.joint());
  const auto plan = plan_of(16, 18);
  for (const Rung rung : {Rung::field, Rung::scatterers}) {
    auto options = simulation_preset(ScanPreset::clinical);
    options.fidelity = rung;
    options.scatterers_per_cell = 1;
    options.display.persistence = 0.3;
    options.threads = 1;
    const ProbeSimulator one(subject, plan, options);
    options.threads = 3;
    const ProbeSimulator three(subject, plan, options);
    const auto volume = one.volume(1);
    EXPECT_EQ(volume, three.volume(1));
    const std::uint64_t first = plan.first_sequence(1);
    auto blocks = three.block(first);
    const auto rest = three.block(first + blocks.size() / 1024);
    blocks.insert(blocks.end(), rest.begin(), rest.end());
    EXPECT_EQ(volume, blocks);
    options.seed = 2;
    EXPECT_NE(volume, ProbeSimulator(subject, plan, options).volume(1));
  }
}

}  // namespace
}  // namespace wobblebench::sim
