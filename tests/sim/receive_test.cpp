#include "sim/receive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace wobblebench::sim {
namespace {

using Complex = std::complex<float>;

const hw::AcquisitionPlan& plan() {
  static const hw::AcquisitionPlan default_plan({}, {});
  return default_plan;
}

SimulationOptions quiet_linear() {
  SimulationOptions options;
  options.noise_db = kSilent_db;
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
  const std::vector<Complex> iq = {{3, 4}, {-5, 0}, {0, 5}, {4, -3}};
  std::vector<float> samples(2);
  receive(iq, 1, plan(), quiet_linear(), samples);
  EXPECT_FLOAT_EQ(samples[0], 5);
  EXPECT_FLOAT_EQ(samples[1], 5);
}

TEST(Receive, LowPassAveragesAndItsAbsencePicks) {
  const std::vector<Complex> iq = {{1, 0}, {3, 0}, {0, 2}, {0, 6}};
  std::vector<float> samples(2);
  auto options = quiet_linear();
  receive(iq, 1, plan(), options, samples);
  EXPECT_FLOAT_EQ(samples[0], 2);
  EXPECT_FLOAT_EQ(samples[1], 4);
  options.low_pass = false;
  receive(iq, 1, plan(), options, samples);
  EXPECT_FLOAT_EQ(samples[0], 3);
  EXPECT_FLOAT_EQ(samples[1], 6);
}

TEST(Receive, NoiseHasItsLevelAndIsItsSticksOwn) {
  auto options = quiet_linear();
  options.noise_db = -40;
  const std::vector<Complex> silence(20000);
  std::vector<float> a(10000), b(10000);
  receive(silence, 1, plan(), options, a);
  receive(silence, 2, plan(), options, b);
  EXPECT_NE(a, b);
  double mean = 0;
  for (float value : a) mean += static_cast<double>(value) / 10000;
  EXPECT_NEAR(mean, 0.01 * std::sqrt(kPi) / 2, 1e-4) << "Rayleigh mean of RMS 0.01";
}

}  // namespace
}  // namespace wobblebench::sim
