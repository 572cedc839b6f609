// No sample leaves the receive chain that is not finite, whatever the options allow.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "sim/probe_simulator.h"

namespace wobblebench::sim {
namespace {

/// Sets every described field to its least or its greatest value, or to one between, in equal
/// shares.
class RandomExtremes {
 public:
  explicit RandomExtremes(unsigned seed) : random_(seed) {}

  void real(std::string_view, double& value, double unit, double min, double max) {
    value = unit * pick(min, max);
  }
  void integer(std::string_view, int& value, int min, int max) {
    value = static_cast<int>(std::lround(pick(min, max)));
  }
  void seed(std::string_view, std::uint64_t& value) { value = random_(); }
  void flag(std::string_view, bool& value) { value = random_() % 2 == 0; }
  template <class Enum>
  void choice(std::string_view,
              Enum& value,
              std::initializer_list<std::pair<std::string_view, Enum>> names) {
    value = (names.begin() + random_() % names.size())->second;
  }

 private:
  double pick(double min, double max) {
    switch (random_() % 3) {
      case 0:
        return min;
      case 1:
        return max;
      default:
        return std::uniform_real_distribution<double>(min, max)(random_);
    }
  }

  std::mt19937 random_;
};

/// Four sticks of a sphere. Few samples and scatterers: the extremes are those of the amplitudes.
struct Scene {
  explicit Scene(unsigned seed) {
    RandomExtremes extremes(seed);
    describe(probe, extremes);
    describe(acquisition, extremes);
    describe(options, extremes);
    probe.wobble_radius_m = std::min(probe.wobble_radius_m, probe.radius_m);
    probe.elements = std::min(probe.elements, 16);
    acquisition.sticks_per_frame = acquisition.frames_per_volume = 2;
    acquisition.samples_per_stick = std::min(acquisition.samples_per_stick, 64);
    acquisition.volumes = 1;
    // More zones take longer than a stick may where the dead time is the longest.
    if (acquisition.dead_time_s > 1e-3) acquisition.focal_zones = 1;
    options.threads = 1;
    options.scatterers_per_cell = 0.1;
    if (options.fidelity == Rung::reference) options.fidelity = Rung::automatic;
    if (options.side_lobes) options.fidelity = Rung::scatterers;
    // Its time grows with the scatterers in the beam.
    if (options.fidelity == Rung::scatterers) {
      acquisition.depth_m = std::min(acquisition.depth_m, 60e-3);
      probe.center_frequency_hz = std::min(probe.center_frequency_hz, 5e6);
      // Lower elements are refused.
      const double wavelength_m = acquisition.sound_speed_m_s / probe.center_frequency_hz;
      probe.element_height_m = std::max(probe.element_height_m, 4 * wavelength_m);
      options.speckle = true;
    }
    if (options.fidelity == Rung::geometry) options.tissue_sound_speed = false;
  }

  hw::ProbeOptions probe;
  hw::AcquisitionOptions acquisition;
  SimulationOptions options;
};

const phantoms::Phantom& ball() {
  static const auto phantom = phantoms::make_phantom({.name = "sphere", .voxel_m = 2e-3});
  return phantom;
}

VolumeSamples scanned(const Scene& scene) {
  // 30 mm below the face.
  const glm::dvec3 center_m(0, 0, scene.probe.radius_m + 50e-3);
  const hw::AcquisitionPlan plan(scene.probe, scene.acquisition);
  return ProbeSimulator(phantoms::still_at(ball(), center_m), plan, scene.options).volume(0);
}

TEST(FiniteSamples, AtTheExtremesOfAllOptions) {
  int linear = 0;
  for (unsigned seed = 1; seed <= 32; ++seed) {
    const Scene scene(seed);
    const auto samples = scanned(scene);
    const bool log = scene.options.output == hw::SampleScale::log_compressed;
    linear += log ? 0 : 1;
    const auto bad = std::count_if(samples.begin(), samples.end(), [&](float sample) {
      return !std::isfinite(sample) || sample < 0 || (log && sample > 1);
    });
    EXPECT_EQ(bad, 0) << "of " << samples.size() << " samples, seed " << seed;
  }
  EXPECT_GT(linear, 8);
}

/// 20 MHz and 3 dB/cm/MHz: a gain of 1920 dB at 16 cm.
TEST(FiniteSamples, BeyondTheLargestFloat) {
  for (const bool speckle : {true, false}) {
    Scene scene(1);
    scene.probe = {};
    scene.probe.center_frequency_hz = 20e6;
    scene.acquisition = {};
    scene.acquisition.sticks_per_frame = scene.acquisition.frames_per_volume = 3;
    scene.options = {};
    scene.options.tgc_db_per_cm_mhz = 3;
    scene.options.speckle = speckle;
    scene.options.output = hw::SampleScale::linear_envelope;
    for (const double noise_db : {-95.0, kZeroAmplitude_db}) {
      scene.options.noise_db = noise_db;
      const auto samples = scanned(scene);
      EXPECT_TRUE(std::all_of(
          samples.begin(), samples.end(), [](float s) { return std::isfinite(s) && s >= 0; }))
          << "noise " << noise_db;
      EXPECT_GT(*std::max_element(samples.begin(), samples.end()), 1e20f);
    }
  }
}

/// Without TGC no echo is stronger than that of a perfect mirror, 1; uniform tissue at -28 dB
/// echoes near the face as elsewhere, where the aperture is narrower than the two middle elements.
TEST(FiniteSamples, NearTheFaceOfAnApodisedArray) {
  for (const auto apodisation : {Apodisation::rectangular, Apodisation::hann, Apodisation::tukey}) {
    for (const Rung rung : {Rung::field, Rung::scatterers}) {
      Scene scene(1);
      scene.probe = {};
      scene.acquisition = {};
      scene.acquisition.depth_m = 60e-3;
      scene.acquisition.sticks_per_frame = 5;
      scene.acquisition.frames_per_volume = 2;
      scene.options = {};
      scene.options.apodisation = apodisation;
      scene.options.fidelity = rung;
      scene.options.output = hw::SampleScale::linear_envelope;
      scene.options.full_scale_db = 0;
      scene.options.tgc_db_per_cm_mhz = 0;
      const auto samples = scanned(scene);
      EXPECT_LT(*std::max_element(samples.begin(), samples.end()), 1)
          << static_cast<int>(apodisation) << " " << static_cast<int>(rung);
    }
  }
}

}  // namespace
}  // namespace wobblebench::sim
