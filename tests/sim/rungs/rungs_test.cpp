// Scans of a sphere by each rung, compared with closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "sim/losses/losses.h"
#include "sim/optics/pulse_band.h"
#include "sim/probe_simulator.h"
#include "tests/support/expect.h"

namespace wobblebench::sim {
namespace {

struct Scan {
  hw::AcquisitionPlan plan;
  VolumeSamples samples;
  std::vector<std::string> effects;

  float sample(int frame, int line, int k) const {
    const auto& a = plan.acquisition();
    return samples[static_cast<std::size_t>(
        (frame * a.sticks_per_frame + line) * a.samples_per_stick + k)];
  }
};

/// The same phantom with smooth interfaces and no backscatter: its echo is only specular.
phantoms::Phantom specular_only(const phantoms::Phantom& phantom) {
  auto materials = phantom.materials();
  for (auto& material : materials) {
    material.roughness = 0;
    material.backscatter_db = kZeroAmplitude_db;
  }
  // Shares the grids with `owner`, which it keeps alive.
  const auto owner = std::make_shared<const phantoms::Phantom>(phantom);
  return {phantom.name(),
          materials,
          phantom.background(),
          phantom.surfaces(),
          phantom.region_of_interest(),
          phantom.suggested_position_m(),
          {owner, &owner->grids()}};
}

/// A sphere of 20 mm radius, 50 mm below the face. The numbers of sticks and frames are odd, so
/// that the middle stick passes through its centre.
Scan scan_sphere(const SimulationOptions& options, bool smooth = false) {
  hw::AcquisitionOptions acquisition;
  acquisition.sticks_per_frame = 33;
  acquisition.frames_per_volume = 17;
  const hw::AcquisitionPlan plan({}, acquisition);
  auto phantom = phantoms::make_phantom({.name = "sphere"});
  if (smooth) phantom = specular_only(phantom);
  const ProbeSimulator simulator(phantoms::still_at(phantom, {0, 0, 0.11}), plan, options);
  return {plan, simulator.volume(0), simulator.effects()};
}

/// Fluid to soft tissue at normal incidence.
double surface_reflection() {
  return reflection(phantoms::material("amniotic_fluid"), phantoms::material("soft_tissue"), 1);
}

TEST(Rungs, GeometryIsAStepAtTheSurface) {
  SimulationOptions options;
  options.fidelity = Rung::geometry;
  const Scan scan = scan_sphere(options);
  const double expected =
      1 + (phantoms::material("soft_tissue").backscatter_db - options.full_scale_db) /
              options.dynamic_range_db;
  for (int k = 0; k < scan.plan.acquisition().samples_per_stick; ++k) {
    const double range = scan.plan.sample_range_m(k);
    if (std::abs(range - 50e-3) < 0.05e-3 || std::abs(range - 90e-3) < 0.05e-3) continue;
    const bool inside = range > 50e-3 && range < 90e-3;
    EXPECT_NEAR(scan.sample(8, 16, k), inside ? expected : 0, 1e-5) << "range " << range;
  }
}

TEST(Rungs, FieldHasTheSpecularEchoOfTheSurface) {
  SimulationOptions options;
  options.speckle = false;
  options.low_pass = false;
  options.noise_db = kZeroAmplitude_db;
  options.output = hw::SampleScale::linear_envelope;
  options.full_scale_db = 0;
  const Scan scan = scan_sphere(options, true);
  const int front = static_cast<int>(50e-3 / scan.plan.sample_spacing_m());
  float peak = 0;
  for (int k = front - 3; k <= front + 3; ++k) peak = std::max(peak, scan.sample(8, 16, k));
  const auto& fluid = phantoms::material("amniotic_fluid");
  const double through_fluid_db = 2 * fluid.attenuation_db_per_cm_mhz * 3.5 * 5;
  const double gain_db = 2 * options.tgc_db_per_cm_mhz * 3.5 * 5;
  // 50 mm is the border of two samples: the nearest IQ sample lies a quarter of a sample off the
  // pulse.
  const double off = scan.plan.sample_spacing_m() / 4 / sigma_of_fwhm(axial_fwhm_m(scan.plan));
  const double expected = surface_reflection() * std::exp(-0.5 * off * off) *
                          std::pow(10, (gain_db - through_fluid_db) / 20);
  EXPECT_NEAR(peak / expected, 1, 0.01);
}

TEST(Rungs, OnlyEffectsThatAreSwitchedOnRun) {
  SimulationOptions options;
  options.fidelity = Rung::geometry;
  const auto geometry = scan_sphere(options).effects;
  EXPECT_EQ(geometry, (std::vector<std::string>{"tissue_echo", "log_compression"}));
  options = {};
  options.speckle = false;
  const auto field = scan_sphere(options).effects;
  EXPECT_EQ(std::count(field.begin(), field.end(), "speckle"), 0);
  EXPECT_EQ(std::count(field.begin(), field.end(), "interface_echo"), 1);
}

TEST(Rungs, ReflectionIsLostBehindTheSurface) {
  SimulationOptions options;
  options.speckle = false;
  options.interface_echo = false;
  options.noise_db = kZeroAmplitude_db;
  options.attenuation = false;
  options.tgc_db_per_cm_mhz = 0;
  options.output = hw::SampleScale::linear_envelope;
  options.full_scale_db = 0;
  const Scan scan = scan_sphere(options);
  const double r = surface_reflection();
  const double expected =
      std::pow(10, phantoms::material("soft_tissue").backscatter_db / 20) * (1 - r * r);
  const int middle = static_cast<int>(70e-3 / scan.plan.sample_spacing_m());
  EXPECT_NEAR(scan.sample(8, 16, middle) / expected, 1, 1e-3);
}

TEST(Rungs, RefusesOptionsOutOfRange) {
  SimulationOptions options;
  options.dynamic_range_db = 5;
  EXPECT_EQ(refusal_of<InvalidOption>([&] { scan_sphere(options); }),
            "dynamic_range_db = 5: must be within 10 and 200");
}

TEST(Rungs, DefaultsAreValid) {
  EXPECT_NO_THROW(check_options(SimulationOptions{}));
}

}  // namespace
}  // namespace wobblebench::sim
