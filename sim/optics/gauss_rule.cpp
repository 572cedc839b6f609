#include "sim/optics/gauss_rule.h"

#include <cmath>

namespace wobblebench::sim {

namespace {

constexpr int kSamples = 1000;  // of the weight, over the interval

double sample_at(double low, double high, int i) {
  return low + (i + 0.5) * (high - low) / kSamples;
}

}  // namespace

GaussRule::GaussRule(double low, double high, int nodes) {
  find_recurrence(low, high, nodes);
  for (int i = 0; i + 1 < kSamples; ++i) {
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
  for (int i = 0; i < kSamples; ++i) sum += std::exp(-std::pow(sample_at(low, high, i), 2));
  std::vector<double> before(kSamples, 0.0), here(kSamples, 1.0);
  beta_ = {0};
  for (int n = 0; n < nodes; ++n) {
    double mean = 0, square = 0;
    for (int i = 0; i < kSamples; ++i) {
      const double x = sample_at(low, high, i), p = here[static_cast<std::size_t>(i)];
      mean += std::exp(-x * x) / sum * x * p * p;
    }
    for (int i = 0; i < kSamples; ++i) {
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

}  // namespace wobblebench::sim
