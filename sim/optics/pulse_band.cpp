#include "sim/optics/pulse_band.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "sim/optics/point_spread.h"

namespace wobblebench::sim {

namespace {

constexpr double kHighest = 7;  // where the spectrum is 2e-11 of its peak
/// Of the Gauss-Hermite rule with eight nodes: the largest zero of H8.
constexpr double kOutermostNode = 2.9307;
constexpr double kSampling = 0.05;  // of the spectrum: repeats the pulse after 126 sigmas
constexpr int kHalf = 20;           // out of focus an echo is late by a few sigmas
constexpr double kStep_sigmas = 0.25;

}  // namespace

PulseBand::Rule::Rule(double lowest, double cut_at)
    : low(lowest), cut(cut_at), gauss(lowest, kHighest, kNodes) {
  const int count = static_cast<int>(std::ceil((kHighest - low) / kSampling));
  double sum = 0;
  for (int i = 0; i < count; ++i) {
    Sample& sample = samples_.emplace_back();
    sample.x = low + (i + 0.5) * (kHighest - low) / count;
    const double spectrum = std::exp(-0.5 * sample.x * sample.x);
    for (int node = 0; node < kNodes; ++node) {
      sample.share[static_cast<std::size_t>(node)] = spectrum * gauss.lagrange(node, sample.x);
    }
    sum += spectrum;
  }
  for (Sample& sample : samples_) {
    for (double& share : sample.share) share /= sum;
  }
  for (int i = -kHalf; i <= kHalf; ++i) pulses.push_back(pulses_at(i * kStep_sigmas, 0));
}

PulseBand::Values PulseBand::Rule::pulses_at(double x, double down) const {
  Values sum = {};
  const double lowest = down > 0 ? cut : low;
  std::complex<double> phasor = std::polar(1.0, samples_.front().x * x);
  const std::complex<double> step = std::polar(1.0, (samples_[1].x - samples_[0].x) * x);
  for (const Sample& sample : samples_) {
    if (sample.x >= lowest) {
      const double left = down > 0 ? std::exp(-down * (sample.x + 0.5 * down)) : 1;
      for (std::size_t node = 0; node < sum.size(); ++node) {
        sum[node] += left * sample.share[node] * phasor;
      }
    }
    phasor *= step;
  }
  return sum;
}

PulseBand::PulseBand(const hw::AcquisitionPlan& plan)
    : sigma_m_(sigma_of_fwhm(axial_fwhm_m(plan))),
      center_per_m_(2 * kPi * plan.probe().center_frequency_hz /
                    plan.acquisition().sound_speed_m_s) {
  // Cut where the band ends, unless all nodes of the whole rule lie within it.
  const double lowest = -(1 - kLowest) * center_per_m_ * 2 * sigma_m_;
  rule_ = std::make_shared<const Rule>(lowest <= -kOutermostNode ? -kHighest : lowest, lowest);
}

int PulseBand::below_center() const {
  int node = 0;
  while (node + 2 < nodes() && offset_per_m(node + 1) < 0) ++node;
  return node;
}

double PulseBand::offset_per_m(int node) const {
  // A Gaussian pulse of sigma s over range is one of sigma 1 / 2 s over wavenumber.
  return rule_->gauss.nodes()[static_cast<std::size_t>(node)] * 0.5 / sigma_m_;
}

PulseBand::Values PulseBand::pulses(double offset_m, double frequency_ratio) const {
  return rule_->pulses_at(offset_m / sigma_m_, down(frequency_ratio));
}

std::array<double, PulseBand::kNodes> PulseBand::weights(double frequency_ratio) const {
  std::array<double, kNodes> weights = {};
  std::ranges::copy(rule_->gauss.weights(), weights.begin());
  if (frequency_ratio == 1) return weights;
  double sum = 0;
  for (std::size_t node = 0; node < weights.size(); ++node) {
    weights[node] *= std::exp(-2 * down(frequency_ratio) * rule_->gauss.nodes()[node]);
    sum += weights[node];
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

double PulseBand::peak(const Values& response) const {
  constexpr auto count = static_cast<std::size_t>(kNodes);
  double largest = 0;
  for (const Values& at : rule_->pulses) {
    double re = 0, im = 0;
    for (std::size_t i = 0; i < count; ++i) {
      re += response[i].real() * at[i].real() - response[i].imag() * at[i].imag();
      im += response[i].real() * at[i].imag() + response[i].imag() * at[i].real();
    }
    largest = std::max(largest, re * re + im * im);
  }
  return std::sqrt(largest);
}

double PulseBand::power(const Values& response, double frequency_ratio) const {
  const auto share = weights(frequency_ratio);
  double sum = 0;
  for (std::size_t node = 0; node < share.size(); ++node) {
    sum += share[node] * std::norm(response[node]);
  }
  return sum;
}

}  // namespace wobblebench::sim
