#include "sim/receive/receiver.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "sim/losses/losses.h"

namespace wobblebench::sim {
namespace {

using Complex = std::complex<float>;

hw::AcquisitionPlan plan_of(int samples) {
  hw::AcquisitionOptions acquisition;
  acquisition.samples_per_stick = samples;
  return {{}, acquisition};
}

std::vector<float> detected(const std::vector<Complex>& iq,
                            int samples,
                            const SimulationOptions& options,
                            std::uint64_t noise_key = 1) {
  std::vector<float> result(static_cast<std::size_t>(samples));
  Receiver receiver(plan_of(samples), options, static_cast<int>(iq.size()) / samples);
  receiver.detect(iq, noise_key, result);
  return result;
}

SimulationOptions noiseless_linear() {
  SimulationOptions options;
  options.noise_db = kZeroAmplitude_db;
  options.tgc_db_per_cm_mhz = 0;
  options.output = hw::SampleScale::linear_envelope;
  options.full_scale_db = 0;
  return options;
}

TEST(Receive, LogCompressionMapsTheDynamicRangeToUnity) {
  SimulationOptions options;
  options.full_scale_db = -20;
  options.dynamic_range_db = 60;
  EXPECT_FLOAT_EQ(log_compressed(0.1, options), 1);
  EXPECT_FLOAT_EQ(log_compressed(0.1 * std::pow(10, -1.5), options), 0.5);
  EXPECT_EQ(log_compressed(1e-9, options), 0);
  EXPECT_EQ(log_compressed(1e9, options), 1);
  EXPECT_EQ(log_compressed(0, options), 0);
  EXPECT_EQ(log_compressed(std::numeric_limits<double>::quiet_NaN(), options), 0);
}

TEST(Receive, EnvelopeIgnoresPhase) {
  const auto samples = detected({{3, 4}, {-5, 0}, {0, 5}, {4, -3}}, 2, noiseless_linear());
  EXPECT_FLOAT_EQ(samples[0], 5);
  EXPECT_FLOAT_EQ(samples[1], 5);
}

TEST(Receive, LowPassAveragesAndItsAbsenceDecimates) {
  const std::vector<Complex> two_each = {{1, 0}, {3, 0}, {0, 2}, {0, 6}};
  const std::vector<Complex> three_each = {{1, 0}, {2, 0}, {6, 0}, {0, 2}, {0, 1}, {0, 6}};
  auto options = noiseless_linear();
  EXPECT_EQ(detected(two_each, 2, options), (std::vector<float>{2, 4}));
  EXPECT_EQ(detected(three_each, 2, options), (std::vector<float>{3, 3}));
  options.low_pass = false;
  EXPECT_EQ(detected(two_each, 2, options), (std::vector<float>{3, 6}));
  EXPECT_EQ(detected(three_each, 2, options), (std::vector<float>{2, 1}));
}

TEST(Receive, LogOutputFollowsTheFormula) {
  SimulationOptions options;
  options.noise_db = kZeroAmplitude_db;
  std::vector<Complex> iq;
  for (int i = 0; i < 2000; ++i)
    iq.emplace_back(std::pow(10.0f, -0.0025f * static_cast<float>(i)), 0.0f);
  const auto plan = plan_of(2000);
  const auto samples = detected(iq, 2000, options);
  for (int k = 0; k < 2000; ++k) {
    const double gained = static_cast<double>(std::abs(iq[static_cast<std::size_t>(k)])) *
                          time_gain(plan, options, plan.sample_range_m(k));
    EXPECT_NEAR(samples[static_cast<std::size_t>(k)], log_compressed(gained, options), 1e-6);
  }
}

/// The way back is computed from what a stream states, by hw.
TEST(Receive, SamplesComeBackToDecibels) {
  SimulationOptions options;
  options.noise_db = kZeroAmplitude_db;
  const hw::DisplayScale scale{.full_scale_db = options.full_scale_db,
                               .dynamic_range_db = options.dynamic_range_db,
                               .tgc_db_per_cm_mhz = options.tgc_db_per_cm_mhz};
  const auto plan = plan_of(100);
  const std::vector<Complex> echoes(100, {0, 1e-3f});
  for (const auto output : {hw::SampleScale::log_compressed, hw::SampleScale::linear_envelope}) {
    options.output = output;
    const auto samples = detected(echoes, 100, options);
    for (int k = 0; k < 100; ++k) {
      const float sample = samples[static_cast<std::size_t>(k)];
      const double range_m = plan.sample_range_m(k);
      EXPECT_NEAR(hw::echo_db(sample, output, scale, plan, range_m), -60, 1e-4) << k;
    }
  }
}

TEST(Receive, NoiseHasItsLevelAndDependsOnItsKey) {
  auto options = noiseless_linear();
  options.noise_db = -40;
  const std::vector<Complex> no_echo(8192);
  const auto a = detected(no_echo, 4096, options, 1), b = detected(no_echo, 4096, options, 2);
  EXPECT_NE(a, b);
  double mean = 0;
  for (float value : a) mean += static_cast<double>(value) / 4096;
  EXPECT_NEAR(mean, 0.01 * std::sqrt(kPi) / 2, 2e-4) << "Rayleigh mean of RMS 0.01";
}

/// Amplitude of a sequence's spectrum at a frequency, in cycles per sample.
double spectrum_at(std::span<const Complex> iq, double cycles) {
  std::complex<double> sum;
  for (std::size_t i = 0; i < iq.size(); ++i) {
    sum +=
        std::complex<double>(iq[i]) * std::polar(1.0, -2 * kPi * cycles * static_cast<double>(i));
  }
  return std::abs(sum);
}

/// A probe's relative bandwidth is the width of its amplitude spectrum between half of its peak.
TEST(Receive, NoiseHasTheBandOfTheProbe) {
  constexpr int kSamples = 1024, kOversampling = 2, kSticks = 60;
  const auto plan = plan_of(kSamples);
  const double rate_hz =
      kOversampling * plan.acquisition().sound_speed_m_s / 2 / plan.sample_spacing_m();
  auto options = noiseless_linear();
  options.noise_db = -40;
  Receiver receiver(plan, options, kOversampling);
  const std::vector<Complex> no_echo(kSamples * kOversampling);
  const double half_hz = 0.5 * plan.probe().fractional_bandwidth * plan.probe().center_frequency_hz;
  double middle = 0, edge = 0, beyond = 0, power = 0;
  std::vector<Complex> noisy;
  for (std::uint64_t key = 0; key < kSticks; ++key) {
    receiver.add_noise(no_echo, key, noisy);
    for (const Complex z : noisy) power += static_cast<double>(std::norm(z));
    for (int i = -10; i <= 10; ++i) {  // neighbouring, independent frequencies
      const double beside = i / static_cast<double>(no_echo.size());
      middle += std::pow(spectrum_at(noisy, beside), 2);
      edge += std::pow(spectrum_at(noisy, half_hz / rate_hz + beside), 2);
      beyond += std::pow(spectrum_at(noisy, 2 * half_hz / rate_hz + beside), 2);
    }
  }
  EXPECT_NEAR(std::sqrt(edge / middle), 0.5, 0.04);
  EXPECT_NEAR(std::sqrt(beyond / middle), std::pow(0.5, 4), 0.02) << "a Gaussian's";
  EXPECT_NEAR(std::sqrt(power / (kSticks * 2.0 * kSamples)), 0.01, 2e-4) << "RMS";
}

TEST(Receive, SkippedBlocksAreThoseWithoutEchoAndNoise) {
  // TGC makes the noise visible from about half the depth on; one echo lies before.
  SimulationOptions options;
  std::vector<Complex> iq(1024);
  iq[100] = {1e-3f, 0};
  const auto samples = detected(iq, 512, options);
  const auto plan = plan_of(512);
  int shown = 0;
  for (int k = 0; k < 512; ++k) {
    const bool zero = samples[static_cast<std::size_t>(k)] == 0.0f;
    shown += zero ? 0 : 1;
    // RMS of the noise after TGC, relative to the bottom of the dynamic range.
    const double noise_db =
        options.noise_db + 20 * std::log10(time_gain(plan, options, plan.sample_range_m(k)));
    const double floor_db = options.full_scale_db - options.dynamic_range_db;
    if (k != 50 && noise_db < floor_db - 14) {
      EXPECT_TRUE(zero) << k;
    } else if (noise_db > floor_db + 13) {
      EXPECT_FALSE(zero) << k;
    }
  }
  EXPECT_GT(samples[50], 0);
  EXPECT_GT(shown, 10);
}

}  // namespace
}  // namespace wobblebench::sim
