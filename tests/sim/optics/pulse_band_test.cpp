// The band's frequencies against a Gaussian pulse in closed form, and the wide band's against a
// direct integral.
#include "sim/optics/pulse_band.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/units.h"

namespace wobblebench::sim {
namespace {

PulseBand band_of(double fractional_bandwidth) {
  hw::ProbeOptions probe;
  probe.fractional_bandwidth = fractional_bandwidth;
  return PulseBand(hw::AcquisitionPlan(probe, {}));
}

const PulseBand& band() {
  static const PulseBand shared(hw::AcquisitionPlan({}, {}));
  return shared;
}

const PulseBand& wide_band() {
  static const PulseBand shared = band_of(1.0);
  return shared;
}

/// The same response at all nodes.
PulseBand::Values flat(double value) {
  PulseBand::Values response;
  response.fill(value);
  return response;
}

/// The echo of a response at a distance behind its range.
std::complex<double> echo(const PulseBand& band,
                          const PulseBand::Values& response,
                          double offset_m,
                          double frequency_ratio = 1) {
  std::complex<double> sum = 0;
  const PulseBand::Values pulses = band.pulses(offset_m, frequency_ratio);
  for (std::size_t node = 0; node < pulses.size(); ++node) sum += response[node] * pulses[node];
  return sum;
}

/// Delays by a range, demodulated by the centre frequency.
PulseBand::Values delay(const PulseBand& band, double delay_m) {
  PulseBand::Values response = {};
  for (int node = 0; node < band.nodes(); ++node) {
    response[static_cast<std::size_t>(node)] =
        std::polar(1.0, -2 * band.offset_per_m(node) * delay_m);
  }
  return response;
}

double gaussian(double sigmas) {
  return std::exp(-0.5 * sigmas * sigmas);
}

/// Envelope of the pulse without the frequencies below a fifth of the centre's, by direct sum.
double cut_pulse(const PulseBand& band, double sigmas) {
  constexpr double kStep = 1e-3;
  const double lowest = -0.8 * band.center_per_m() * 2 * band.sigma_m();
  std::complex<double> sum = 0;
  double flat = 0;
  for (double x = lowest + 0.5 * kStep; x < 8; x += kStep) {
    sum += std::exp(-0.5 * x * x) * std::polar(1.0, x * sigmas);
    flat += std::exp(-0.5 * x * x);
  }
  return std::abs(sum) / flat;
}

TEST(PulseBand, AFlatResponseEchoesThePulse) {
  for (double sigmas = -4; sigmas <= 4; sigmas += 0.25) {
    const auto found = echo(band(), flat(1), sigmas * band().sigma_m());
    EXPECT_NEAR(found.real(), gaussian(sigmas), 1e-9);
    EXPECT_NEAR(found.imag(), 0, 1e-9);
    const auto wide = echo(wide_band(), flat(1), sigmas * wide_band().sigma_m());
    EXPECT_NEAR(std::abs(wide), cut_pulse(wide_band(), sigmas), 2e-3) << sigmas;
  }
}

TEST(PulseBand, ADelayMovesThePulse) {
  // Out of focus the path lengths of an echo differ by this amount; with four nodes the echo of a
  // delay of 1.8 sigmas is wrong by 0.29 of its peak.
  for (double shift : {-1.8, -0.9, 0.6, 1.8}) {
    const auto response = delay(band(), shift * band().sigma_m());
    for (double sigmas = -3; sigmas <= 3; sigmas += 0.25) {
      const auto found = echo(band(), response, sigmas * band().sigma_m());
      EXPECT_NEAR(std::abs(found), gaussian(sigmas - shift), 0.012) << shift << " " << sigmas;
    }
  }
}

TEST(PulseBand, ALowerPulseKeepsItsLengthAndTurns) {
  // The transform of a Gaussian spectrum about a lower centre, demodulated by the centre sent.
  const double ratio = 0.8, down = 2 * 0.2 * band().center_per_m();
  for (double shift : {0.0, -0.9, 1.2}) {
    const auto response = delay(band(), shift * band().sigma_m());
    for (double sigmas = -3; sigmas <= 3; sigmas += 0.25) {
      const double x = sigmas - shift;
      const auto expected = std::polar(gaussian(x), -down * x * band().sigma_m());
      const auto found = echo(band(), response, sigmas * band().sigma_m(), ratio);
      EXPECT_NEAR(std::abs(found - expected), 0, 0.03) << shift << " " << sigmas;
    }
  }
}

TEST(PulseBand, WeightsOfALowerPulseHaveItsMeanFrequency) {
  for (double ratio : {0.95, 0.8, 0.6, 0.4}) {
    double sum = 0, mean = 0, square = 0;
    const auto weights = band().weights(ratio);
    for (int node = 0; node < band().nodes(); ++node) {
      const double weight = weights[static_cast<std::size_t>(node)];
      const double away = band().wavenumber_per_m(node) - ratio * band().center_per_m();
      sum += weight;
      mean += weight * away;
      square += weight * away * away;
    }
    const double sigma = 1 / (2 * std::sqrt(2.0) * band().sigma_m());
    EXPECT_NEAR(sum, 1, 1e-12);
    EXPECT_NEAR(mean / sigma, 0, ratio < 0.5 ? 0.1 : 0.02) << ratio;
    EXPECT_NEAR(square / (sigma * sigma), 1, ratio < 0.5 ? 0.3 : 0.05) << ratio;
  }
}

TEST(PulseBand, ADelayMovesAWideBandsPulse) {
  for (double shift : {-1.8, -0.9, 0.6, 1.8}) {
    const auto response = delay(wide_band(), shift * wide_band().sigma_m());
    for (double sigmas = -3; sigmas <= 3; sigmas += 0.25) {
      const auto found = echo(wide_band(), response, sigmas * wide_band().sigma_m());
      EXPECT_NEAR(std::abs(found), cut_pulse(wide_band(), sigmas - shift), 0.03)
          << shift << " " << sigmas;
    }
  }
}

TEST(PulseBand, NodesAreAGaussHermiteRule) {
  // Moments of the pulse's power spectrum, of sigma 1 / (2 sqrt 2 sigma_m).
  const double sigma = 1 / (2 * std::sqrt(2.0) * band().sigma_m());
  double sum = 0, mean = 0, square = 0, fourth = 0;
  for (int node = 0; node < band().nodes(); ++node) {
    const double weight = band().weight(node), x = band().offset_per_m(node) / sigma;
    sum += weight;
    mean += weight * x;
    square += weight * x * x;
    fourth += weight * x * x * x * x;
  }
  EXPECT_NEAR(sum, 1, 1e-9);
  EXPECT_NEAR(mean, 0, 1e-9);
  EXPECT_NEAR(square, 1, 1e-9);
  EXPECT_NEAR(fourth, 3, 1e-8);
}

TEST(PulseBand, TheCentreLiesBetweenTwoNodes) {
  for (const PulseBand& each : {band(), wide_band(), band_of(1.5)}) {
    EXPECT_LT(each.offset_per_m(each.below_center()), 0);
    EXPECT_GE(each.offset_per_m(each.below_center() + 1), 0);
  }
}

TEST(PulseBand, PeakAndPowerOfAnEcho) {
  EXPECT_NEAR(band().peak(flat(1)), 1, 1e-9);
  EXPECT_NEAR(band().peak(delay(band(), 0.3 * band().sigma_m())), 1, 0.01);
  EXPECT_NEAR(band().power(flat(2)), 4, 1e-6);
  EXPECT_NEAR(wide_band().peak(flat(1)), 1, 1e-3);
  EXPECT_NEAR(wide_band().power(flat(2)), 4, 1e-6);
}

TEST(PulseBand, StaysAtPositiveFrequencies) {
  const PulseBand wide = band_of(1.5);
  for (int node = 0; node < wide.nodes(); ++node) {
    EXPECT_GE(wide.wavenumber_per_m(node), 0.2 * wide.center_per_m());
  }
}

TEST(GaussRule, OnTheWholeAxisItIsGaussHermite) {
  // Table 25.10, n = 4 and n = 8; weights over sqrt(pi).
  const GaussRule four(-7, 7, 4);
  ASSERT_EQ(four.nodes().size(), 4u);
  EXPECT_NEAR(four.nodes()[0], -1.650680123885785, 1e-9);
  EXPECT_NEAR(four.nodes()[2], 0.524647623275290, 1e-9);
  EXPECT_NEAR(four.weights()[0], 0.08131283544725 / std::sqrt(kPi), 1e-9);
  EXPECT_NEAR(four.weights()[2], 0.8049140900055 / std::sqrt(kPi), 1e-9);
  const GaussRule eight(-7, 7, 8);
  ASSERT_EQ(eight.nodes().size(), 8u);
  EXPECT_NEAR(eight.nodes()[7], 2.930637420257244, 1e-8);
  EXPECT_NEAR(eight.weights()[7], 1.996040722114e-4 / std::sqrt(kPi), 1e-9);
}

TEST(GaussRule, IntegratesOverACutGaussian) {
  // The mean of x over exp(-x^2) from `low` on: exp(-low^2) / (sqrt(pi) erfc(low)); the mean
  // square is 1/2 + low times the mean, by parts.
  const double low = -1.3;
  const GaussRule rule(low, 7, 8);
  double sum = 0, mean = 0, square = 0;
  for (std::size_t i = 0; i < rule.nodes().size(); ++i) {
    EXPECT_GT(rule.nodes()[i], low);
    sum += rule.weights()[i];
    mean += rule.weights()[i] * rule.nodes()[i];
    square += rule.weights()[i] * rule.nodes()[i] * rule.nodes()[i];
  }
  const double expected = std::exp(-low * low) / (std::sqrt(kPi) * std::erfc(low));
  EXPECT_NEAR(sum, 1, 1e-9);
  EXPECT_NEAR(mean, expected, 1e-5);
  EXPECT_NEAR(square, 0.5 + low * expected, 1e-5);
}

TEST(GaussRule, LagrangePolynomialsInterpolate) {
  const GaussRule rule(-2, 7, 8);
  for (int node = 0; node < 8; ++node) {
    for (int at = 0; at < 8; ++at) {
      EXPECT_NEAR(rule.lagrange(node, rule.nodes()[static_cast<std::size_t>(at)]),
                  node == at ? 1 : 0,
                  1e-8);
    }
  }
  double cube = 0;
  for (int node = 0; node < 8; ++node) {
    cube += std::pow(rule.nodes()[static_cast<std::size_t>(node)], 3) * rule.lagrange(node, 0.7);
  }
  EXPECT_NEAR(cube, 0.7 * 0.7 * 0.7, 1e-8);
}

}  // namespace
}  // namespace wobblebench::sim
