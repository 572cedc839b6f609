#include "sim/optics/pulse_band.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"

namespace wobblebench::sim {

namespace {

constexpr double kHighest = 7;  ///< the spectrum is 2e-11 of its peak there
/// Outermost node of the Gauss-Hermite rule with eight nodes: the largest zero of H8.
constexpr double kOutermostNode = 2.9307;
/// Step of the sampled spectrum: the pulse repeats after 126 standard deviations.
constexpr double kSampling = 0.05;
constexpr int kHalf = 20;  ///< out of focus an echo is late by a few standard deviations
constexpr double kStep_sigmas = 0.25;

constexpr int kWeightSamples = 1000;  ///< over the interval

double sample_at(double low, double high, int i) {
  return low + (i + 0.5) * (high - low) / kWeightSamples;
}

}  // namespace

double axial_fwhm_m(const hw::AcquisitionPlan& plan) {
  const auto& probe = plan.probe();
  return 0.5 * plan.acquisition().sound_speed_m_s * 0.8825 /
         (probe.fractional_bandwidth * probe.center_frequency_hz);
}

int iq_oversampling(const hw::AcquisitionPlan& plan) {
  const auto& acquisition = plan.acquisition();
  const double output_rate_hz = acquisition.sound_speed_m_s / (2 * plan.sample_spacing_m());
  const double band_hz = plan.probe().fractional_bandwidth * plan.probe().center_frequency_hz;
  // A Gaussian pulse is 29 dB down at 2.2 times its -6 dB band.
  return std::max(1, static_cast<int>(std::ceil(2.2 * band_hz / output_rate_hz)));
}

double sigma_of_fwhm(double fwhm) {
  return fwhm / (2 * std::sqrt(2 * std::log(2.0)));
}

double power_sigma(double amplitude_fwhm) {
  return sigma_of_fwhm(amplitude_fwhm) / std::sqrt(2.0);
}

GaussRule::GaussRule(double low, double high, int nodes) {
  find_recurrence(low, high, nodes);
  for (int i = 0; i + 1 < kWeightSamples; ++i) {
    const double from = sample_at(low, high, i), to = sample_at(low, high, i + 1);
    if (polynomials(from).back() * polynomials(to).back() > 0) continue;
    nodes_.push_back(zero_between(from, to));
    double square = 0;
    const std::vector<double> at = polynomials(nodes_.back());
    for (int n = 0; n < nodes; ++n) {
      square += at[static_cast<std::size_t>(n)] * at[static_cast<std::size_t>(n)];
    }
    weights_.push_back(1 / square);
  }
}

void GaussRule::find_recurrence(double low, double high, int nodes) {
  double sum = 0;
  for (int i = 0; i < kWeightSamples; ++i) sum += std::exp(-std::pow(sample_at(low, high, i), 2));
  std::vector<double> before(kWeightSamples, 0.0), here(kWeightSamples, 1.0);
  beta_ = {0};
  for (int n = 0; n < nodes; ++n) {
    double mean = 0, square = 0;
    for (int i = 0; i < kWeightSamples; ++i) {
      const double x = sample_at(low, high, i), p = here[static_cast<std::size_t>(i)];
      mean += std::exp(-x * x) / sum * x * p * p;
    }
    for (int i = 0; i < kWeightSamples; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const double x = sample_at(low, high, i);
      before[at] = (x - mean) * here[at] - beta_.back() * before[at];
      square += std::exp(-x * x) / sum * before[at] * before[at];
    }
    alpha_.push_back(mean);
    beta_.push_back(std::sqrt(square));
    for (double& value : before) value /= beta_.back();
    before.swap(here);
  }
}

std::vector<double> GaussRule::polynomials(double x) const {
  std::vector<double> p = {1};
  for (std::size_t n = 0; n < alpha_.size(); ++n) {
    const double before = n == 0 ? 0 : beta_[n] * p[n - 1];
    p.push_back(((x - alpha_[n]) * p[n] - before) / beta_[n + 1]);
  }
  return p;
}

double GaussRule::zero_between(double low, double high) const {
  const double sign = polynomials(low).back();
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (low + high);
    (polynomials(middle).back() * sign > 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double GaussRule::lagrange(int node, double x) const {
  const auto at = static_cast<std::size_t>(node);
  const std::vector<double> here = polynomials(x), there = polynomials(nodes_[at]);
  double sum = 0;
  for (std::size_t n = 0; n + 1 < here.size(); ++n) sum += here[n] * there[n];
  return weights_[at] * sum;
}

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
  double flat = 0;
  const double lowest = down > 0 ? cut : low;
  std::complex<double> phasor = std::polar(1.0, samples_.front().x * x);
  const std::complex<double> step = std::polar(1.0, (samples_[1].x - samples_[0].x) * x);
  for (const Sample& sample : samples_) {
    if (sample.x >= lowest) {
      const double left = std::exp(-down * (sample.x - lowest));
      for (std::size_t node = 0; node < sum.size(); ++node) {
        sum[node] += left * sample.share[node] * phasor;
        flat += left * sample.share[node];
      }
    }
    phasor *= step;
  }
  for (std::complex<double>& value : sum) value /= flat;
  return sum;
}

double PulseBand::Rule::length(double down) const {
  const double lowest = down > 0 ? cut : low;
  double sum = 0, square = 0;
  for (const Sample& sample : samples_) {
    if (sample.x < lowest) continue;
    const double left = std::exp(-0.5 * sample.x * sample.x - down * (sample.x - lowest));
    sum += left;
    square += left * left;
  }
  return 2 * kPi * square / (sum * sum * (samples_[1].x - samples_[0].x));  // by Parseval
}

PulseBand::PulseBand(const hw::AcquisitionPlan& plan)
    : sigma_m_(sigma_of_fwhm(axial_fwhm_m(plan))),
      center_per_m_(2 * kPi * plan.probe().center_frequency_hz /
                    plan.acquisition().sound_speed_m_s) {
  // The rule ends at the lower end of the band, unless all nodes of the whole rule lie above it.
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

double PulseBand::length_m(double frequency_ratio) const {
  return sigma_m_ * rule_->length(down(frequency_ratio));
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
