// The band's four frequencies against a Gaussian pulse in closed form.
#include "sim/beam/response/pulse_band.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/units.h"

namespace wobblebench::sim {
namespace {

const PulseBand& band() {
  static const PulseBand shared(hw::AcquisitionPlan({}, {}));
  return shared;
}

/// The echo of a response at a distance behind its range.
std::complex<double> echo(const PulseBand::Values& response, double offset_m) {
  std::complex<double> sum = 0;
  for (int node = 0; node < PulseBand::kNodes; ++node) {
    sum += response[static_cast<std::size_t>(node)] * band().pulse(node, offset_m);
  }
  return sum;
}

/// Delays by a range, demodulated by the centre frequency.
PulseBand::Values delay(double delay_m) {
  PulseBand::Values response;
  for (int node = 0; node < PulseBand::kNodes; ++node) {
    response[static_cast<std::size_t>(node)] =
        std::polar(1.0, -2 * band().offset_per_m(node) * delay_m);
  }
  return response;
}

double gaussian(double sigmas) {
  return std::exp(-0.5 * sigmas * sigmas);
}

TEST(PulseBand, AFlatResponseEchoesThePulse) {
  for (double sigmas = -4; sigmas <= 4; sigmas += 0.25) {
    const auto found = echo({1, 1, 1, 1}, sigmas * band().sigma_m());
    EXPECT_NEAR(found.real(), gaussian(sigmas), 1e-12);
    EXPECT_NEAR(found.imag(), 0, 1e-12);
  }
}

TEST(PulseBand, ADelayMovesThePulse) {
  // The cubic over the band holds for delays of a fraction of the pulse.
  for (double shift : {-0.6, -0.2, 0.3, 0.6}) {
    const auto response = delay(shift * band().sigma_m());
    for (double sigmas = -3; sigmas <= 3; sigmas += 0.25) {
      const auto found = echo(response, sigmas * band().sigma_m());
      EXPECT_NEAR(std::abs(found), gaussian(sigmas - shift), 0.012) << shift << " " << sigmas;
    }
  }
}

TEST(PulseBand, NodesAreAGaussHermiteRule) {
  // Moments of the pulse's power spectrum, of sigma 1 / (2 sqrt 2 sigma_m).
  const double sigma = 1 / (2 * std::sqrt(2.0) * band().sigma_m());
  double sum = 0, mean = 0, square = 0, fourth = 0;
  for (int node = 0; node < PulseBand::kNodes; ++node) {
    const double weight = PulseBand::weight(node), x = band().offset_per_m(node) / sigma;
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

TEST(PulseBand, PeakAndPowerOfAnEcho) {
  EXPECT_NEAR(PulseBand::peak({1, 1, 1, 1}), 1, 1e-9);
  EXPECT_NEAR(PulseBand::peak(delay(0.3 * band().sigma_m())), 1, 0.01);
  EXPECT_NEAR(PulseBand::power({2, 2, 2, 2}), 4, 1e-6);
}

TEST(PulseBand, StaysAtPositiveFrequencies) {
  hw::ProbeOptions probe;
  probe.fractional_bandwidth = 1.5;
  const PulseBand wide(hw::AcquisitionPlan(probe, {}));
  for (int node = 0; node < PulseBand::kNodes; ++node) {
    EXPECT_GE(wide.wavenumber_per_m(node), 0.2 * wide.center_per_m());
  }
}

}  // namespace
}  // namespace wobblebench::sim
