// The IQ samples of a stick are what its detected samples are made of: detected once more here, in
// double precision, by formulas of this file's own.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "sim/probe_simulator.h"

namespace wobblebench::sim {
namespace {

using Complex = std::complex<float>;
using Volume = std::map<std::uint64_t, std::vector<Complex>>;  ///< by sequence number

constexpr int kIqSamples = 64;

hw::AcquisitionPlan iq_plan() {
  return {{},
          {.depth_m = 40e-3,
           .sector_rad = 0.02,
           .fan_rad = 0.02,
           .sticks_per_frame = 3,
           .samples_per_stick = kIqSamples,
           .frames_per_volume = 2,
           .volumes = 2,
           .motor = hw::MotorMode::alternating}};
}

phantoms::PlacedPhantom placed_sphere(const hw::AcquisitionPlan& plan) {
  static const auto phantom = phantoms::make_phantom({.name = "sphere", .radius_m = 4e-3});
  return phantoms::still_at(phantom, {0, 0, plan.probe().radius_m + 20e-3});
}

SimulationOptions iq_options(Rung rung) {
  SimulationOptions options;
  options.fidelity = rung;
  options.scatterers_per_cell = 1;
  options.noise_db = -70;
  options.tgc_db_per_cm_mhz = 0.7;
  options.full_scale_db = -20;
  options.dynamic_range_db = 45;
  return options;
}

/// The samples of volume 1, and its IQ samples.
std::pair<VolumeSamples, Volume> scanned(const SimulationOptions& options) {
  const auto plan = iq_plan();
  const ProbeSimulator simulator(placed_sphere(plan), plan, options);
  Volume iq;
  std::mutex mutex;
  const auto samples = simulator.volume(1, [&](const hw::StickIndex& index, auto values) {
    const std::lock_guard lock(mutex);
    EXPECT_EQ(index.volume, 1U);
    EXPECT_TRUE(iq.try_emplace(plan.sequence(index), values.begin(), values.end()).second);
  });
  EXPECT_EQ(samples, simulator.volume(1)) << "asking for IQ changes the samples";
  return {samples, iq};
}

double detected(const std::vector<Complex>& iq, int k, const SimulationOptions& options) {
  const std::size_t each = iq.size() / kIqSamples, first = static_cast<std::size_t>(k) * each;
  double envelope = 0;
  for (std::size_t i = first; i < first + each; ++i) {
    envelope += std::hypot(double(iq[i].real()), double(iq[i].imag())) / static_cast<double>(each);
  }
  if (!options.low_pass) {
    const Complex middle = iq[first + each / 2];
    envelope = std::hypot(double(middle.real()), double(middle.imag()));
  }
  const double range_cm = (k + 0.5) / kIqSamples * 4.0;
  const double gain_db = 2 * options.tgc_db_per_cm_mhz * 3.5 * range_cm - options.full_scale_db;
  const double amplitude = envelope * std::pow(10, gain_db / 20);
  if (options.output == hw::SampleScale::linear_envelope) return amplitude;
  return std::clamp(1 + 20 * std::log10(amplitude) / options.dynamic_range_db, 0.0, 1.0);
}

void expect_detected(const SimulationOptions& options) {
  const auto [samples, iq] = scanned(options);
  ASSERT_EQ(iq.size(), 6U);
  std::size_t at = 0;
  int shown = 0;
  for (const auto& [sequence, stick] : iq) {
    EXPECT_EQ(stick.size() % kIqSamples, 0U);
    for (int k = 0; k < kIqSamples; ++k) {
      const double expected = detected(stick, k, options);
      const double sample = static_cast<double>(samples.at(at++));
      const bool linear = options.output == hw::SampleScale::linear_envelope;
      ASSERT_NEAR(sample, expected, linear ? 1e-6 * expected : 2e-6)
          << to_string(options.fidelity) << " stick " << sequence << " sample " << k;
      shown += sample > 0 && sample < 1 ? 1 : 0;
    }
  }
  EXPECT_GT(shown, 50) << "nearly all samples are clamped";
}

TEST(IqSamples, DetectedTheyAreTheSamplesOfEachRung) {
  for (const Rung rung : {Rung::field, Rung::scatterers, Rung::reference}) {
    expect_detected(iq_options(rung));
  }
}

TEST(IqSamples, DetectedTheyAreTheSamplesOfEachReceiveChain) {
  for (const auto output : {hw::SampleScale::log_compressed, hw::SampleScale::linear_envelope}) {
    for (const bool low_pass : {true, false}) {
      auto options = iq_options(Rung::field);
      options.output = output;
      options.low_pass = low_pass;
      expect_detected(options);
    }
  }
}

TEST(IqSamples, WithoutNoiseTheyAreTheEchoes) {
  auto options = iq_options(Rung::field);
  options.noise_db = kZeroAmplitude_db;
  expect_detected(options);
}

/// At -70 dB, in each of its samples.
TEST(IqSamples, HoldTheNoise) {
  auto options = iq_options(Rung::field);
  options.speckle = false;
  const auto noisy = scanned(options).second;
  options.noise_db = kZeroAmplitude_db;
  const auto clean = scanned(options).second;
  double power = 0;
  std::size_t count = 0;
  for (const auto& [sequence, stick] : noisy) {
    for (std::size_t i = 0; i < stick.size(); ++i, ++count) {
      power += static_cast<double>(std::norm(stick[i] - clean.at(sequence)[i]));
    }
  }
  // The power of n circular samples has a relative standard deviation of n^-1/2.
  EXPECT_NEAR(power / static_cast<double>(count) / 1e-7, 1, 5 / std::sqrt(double(count)));
}

/// The demodulated phase of a reflector at range r is -2 pi times its two-way path in wavelengths.
TEST(IqSamples, PhaseIsThatOfTheTwoWayPath) {
  auto materials = phantoms::make_phantom({.name = "sphere"}).materials();
  for (auto& material : materials) {
    material.roughness = 0;
    material.backscatter_db = kZeroAmplitude_db;
  }
  const phantoms::Phantom ball = phantoms::make_phantom({.name = "sphere", .radius_m = 20e-3});
  const phantoms::Phantom smooth(ball.name(),
                                 materials,
                                 ball.background(),
                                 ball.surfaces(),
                                 ball.region_of_interest(),
                                 ball.suggested_position_m(),
                                 {std::make_shared<int>(), &ball.grids()});
  auto options = iq_options(Rung::field);
  options.noise_db = kZeroAmplitude_db;
  options.speckle = false;
  const hw::AcquisitionPlan plan({}, {.sticks_per_frame = 3, .frames_per_volume = 3});
  double previous = 0;
  for (const double front_m : {50e-3, 50e-3 + 1540 / 3.5e6 / 8}) {
    const ProbeSimulator simulator(
        phantoms::still_at(smooth, {0, 0, plan.probe().radius_m + front_m + 20e-3}), plan, options);
    Complex echo = 0;
    simulator.volume(0, [&](const hw::StickIndex& index, auto iq) {
      if (index.frame != 1 || index.line != 1) return;
      echo = iq[static_cast<std::size_t>(front_m / (0.16 / double(iq.size())))];
    });
    EXPECT_GT(std::abs(echo), 1e-3f);
    const double cycles = 2 * front_m * 3.5e6 / 1540;
    const double phase = static_cast<double>(std::arg(echo));
    EXPECT_NEAR(std::remainder(phase + 2 * kPi * cycles, 2 * kPi), 0, 0.1) << front_m;
    if (previous != 0) {
      EXPECT_NEAR(std::remainder(phase - previous, 2 * kPi), -kPi / 2, 0.02);
    }
    previous = phase;
  }
}

TEST(IqSamples, GeometryHasNone) {
  const auto plan = iq_plan();
  const ProbeSimulator simulator(placed_sphere(plan), plan, iq_options(Rung::geometry));
  EXPECT_THROW(simulator.volume(0, [](const auto&, auto) {}), std::logic_error);
}

}  // namespace
}  // namespace wobblebench::sim
