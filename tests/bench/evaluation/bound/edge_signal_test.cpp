// The covariance of an edge against a sum over scatterers, and its derivative against differences.
#include "bench/evaluation/bound/edge_signal.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/units.h"
#include "tests/bench/evaluation/bound/bound_samples.h"

namespace wobblebench::bench {
namespace {

constexpr double kPulse_m = 0.137e-3;
constexpr double kFirst_m = -0.9e-3;
constexpr double kEdge_m = 0.05e-3;
constexpr int kSamples = 14;

/// The integral over ranges u of tissue power(u) h(a - u) h(b - u), h of unit energy.
double echo_covariance(double a_m, double b_m, double footprint_m) {
  const double step_m = 2e-6;
  const double peak2 = 1 / (std::sqrt(kPi) * kPulse_m);
  double sum = 0;
  for (double u = -4e-3; u < 4e-3; u += step_m) {
    const double tissue = 0.5 * std::erfc(-(u - kEdge_m) / (std::sqrt(2.0) * footprint_m));
    const double a = (a_m - u) / kPulse_m, b = (b_m - u) / kPulse_m;
    sum += tissue * peak2 * std::exp(-0.5 * (a * a + b * b)) * step_m;
  }
  return sum;
}

TEST(EdgeSignal, CovarianceIsTheSumOverScatterersBehindTheSurface) {
  constexpr double kFootprint_m = 0.3e-3;
  const EdgeSignal signal = test_signal(40, kFootprint_m);
  const auto covariance = edge_covariance(signal, kEdge_m, kFirst_m, kSamples);
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) {
      const double expected =
          echo_covariance(
              kFirst_m + i * signal.spacing_m, kFirst_m + j * signal.spacing_m, kFootprint_m) +
          (i == j ? 1e-4 : 0);
      EXPECT_NEAR(covariance.value.at(i, j).real(), expected, 1e-5) << i << " " << j;
    }
  }
}

TEST(EdgeSignal, FieldMultipliesSpeckleByTheRootOfTheMeanPower) {
  const EdgeSignal signal = test_signal(40, 0.2e-3, &edge_after_pulse);
  const auto covariance = edge_covariance(signal, kEdge_m, kFirst_m, kSamples);
  const EdgePower power = edge_power(signal, kEdge_m, kFirst_m, kSamples);
  for (int i = 0; i + 1 < kSamples; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double echo2 = (power.value[at] - 1e-4) * (power.value[at + 1] - 1e-4);
    EXPECT_NEAR(covariance.value.at(i, i + 1).real(),
                std::exp(-std::pow(0.156 / (2 * 0.137), 2)) * std::sqrt(echo2),
                1e-12);
    EXPECT_NEAR(covariance.value.at(i, i).real(), power.value[at], 1e-12);
  }
}

TEST(EdgeSignal, DerivativeIsThatOfTheCovarianceByTheSurfacesPlace) {
  constexpr double kStep_m = 1e-8;
  for (const auto order : {&pulse_after_edge, &edge_after_pulse}) {
    EdgeSignal signal = test_signal(40, 0.2e-3, order);
    signal.fluid_power = 0.01;
    const auto at = edge_covariance(signal, kEdge_m, kFirst_m, kSamples);
    const auto low = edge_covariance(signal, kEdge_m - kStep_m, kFirst_m, kSamples);
    const auto high = edge_covariance(signal, kEdge_m + kStep_m, kFirst_m, kSamples);
    for (std::size_t i = 0; i < at.value.values.size(); ++i) {
      const std::complex<double> difference =
          (high.value.values[i] - low.value.values[i]) / (2 * kStep_m);
      EXPECT_LT(std::abs(at.derivative.values[i] - difference),
                1e-3);  // of 1/m, where it reaches 1800
    }
  }
}

}  // namespace
}  // namespace wobblebench::bench
