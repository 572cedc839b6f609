#include "sim/beam/response/pulse_band.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/units.h"
#include "sim/beam/point_spread.h"

namespace wobblebench::sim {

namespace {

constexpr int kNodes = PulseBand::kNodes;
/// Gauss-Hermite rule of four points for the weight exp(-x^2) (Abramowitz and Stegun, table 25.10);
/// weights over sqrt(pi).
constexpr double kNode[kNodes] = {
    -1.6506801238857846, -0.5246476232752903, 0.5246476232752903, 1.6506801238857846};
constexpr double kWeight[kNodes] = {
    0.0458758547680685, 0.4541241452319315, 0.4541241452319315, 0.0458758547680685};

using Cubic = std::array<double, kNodes>;

/// Coefficients of the Lagrange polynomial of a node, by power.
Cubic lagrange(int node) {
  Cubic polynomial = {1, 0, 0, 0};
  for (int other = 0; other < kNodes; ++other) {
    if (other == node) continue;
    Cubic product = {};
    for (std::size_t n = 0; n < kNodes; ++n) {
      if (n + 1 < kNodes) product[n + 1] += polynomial[n] / (kNode[node] - kNode[other]);
      product[n] -= kNode[other] * polynomial[n] / (kNode[node] - kNode[other]);
    }
    polynomial = product;
  }
  return polynomial;
}

const Cubic& lagrange_of(int node) {
  static const std::array<Cubic, kNodes> polynomials = {
      lagrange(0), lagrange(1), lagrange(2), lagrange(3)};
  return polynomials[static_cast<std::size_t>(node)];
}

/// Hermite polynomials He_0 to He_3.
Cubic hermite(double x) {
  return {1, x, x * x - 1, x * (x * x - 3)};
}

/// phi of a node, `x` sigmas of the pulse behind the echo's range.
std::complex<double> pulse_at(int node, double x) {
  const Cubic he = hermite(x), &c = lagrange_of(node);
  // The transform of k^n exp(-k^2 / 2) is i^n He_n(x) exp(-x^2 / 2).
  return std::exp(-0.5 * x * x) *
         std::complex<double>(c[0] * he[0] - c[2] * he[2], c[1] * he[1] - c[3] * he[3]);
}

std::vector<PulseBand::Values> pulses_about_peak() {
  constexpr int kHalf = 20;  // out of focus an echo is late by a few sigmas
  constexpr double kStep_sigmas = 0.25;
  std::vector<PulseBand::Values> pulses;
  for (int i = -kHalf; i <= kHalf; ++i) {
    PulseBand::Values& at = pulses.emplace_back();
    for (int node = 0; node < kNodes; ++node) {
      at[static_cast<std::size_t>(node)] = pulse_at(node, i * kStep_sigmas);
    }
  }
  return pulses;
}

}  // namespace

PulseBand::PulseBand(const hw::AcquisitionPlan& plan)
    : sigma_m_(sigma_of_fwhm(axial_fwhm_m(plan))),
      center_per_m_(2 * kPi * plan.probe().center_frequency_hz /
                    plan.acquisition().sound_speed_m_s) {}

double PulseBand::offset_per_m(int node) const {
  // A Gaussian pulse of sigma s over range is one of sigma 1 / 2 s over wavenumber.
  return kNode[node] * 0.5 / sigma_m_;
}

double PulseBand::wavenumber_per_m(int node) const {
  return std::max(center_per_m_ + offset_per_m(node), kLowest * center_per_m_);
}

double PulseBand::weight(int node) {
  return kWeight[node];
}

std::complex<double> PulseBand::pulse(int node, double offset_m) const {
  return pulse_at(node, offset_m / sigma_m_);
}

double PulseBand::peak(const Values& response) {
  static const std::vector<Values> pulses = pulses_about_peak();
  double largest = 0;
  for (const Values& at : pulses) {
    double re = 0, im = 0;
    for (std::size_t i = 0; i < kNodes; ++i) {
      re += response[i].real() * at[i].real() - response[i].imag() * at[i].imag();
      im += response[i].real() * at[i].imag() + response[i].imag() * at[i].real();
    }
    largest = std::max(largest, re * re + im * im);
  }
  return std::sqrt(largest);
}

double PulseBand::power(const Values& response) {
  double sum = 0;
  for (int node = 0; node < kNodes; ++node) {
    sum += weight(node) * std::norm(response[static_cast<std::size_t>(node)]);
  }
  return sum;
}

}  // namespace wobblebench::sim
