// Complex Gaussian samples, and their log likelihood by elimination: nothing shared with the code
// under test.
#pragma once

#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include "bench/evaluation/bound/edge_signal.h"
#include "tests/bench/evaluation/bound/oracle.h"

namespace wobblebench::bench {

/// A lower triangular matrix L with L L* = matrix.
inline SquareMatrix root_of(const SquareMatrix& matrix) {
  SquareMatrix root(matrix.size);
  for (int i = 0; i < matrix.size; ++i) {
    for (int j = 0; j <= i; ++j) {
      std::complex<double> sum = matrix.at(i, j);
      for (int k = 0; k < j; ++k) sum -= root.at(i, k) * std::conj(root.at(j, k));
      root.at(i, j) = i == j ? std::sqrt(sum.real()) : sum / root.at(j, j);
    }
  }
  return root;
}

inline std::vector<IqSamples> drawn_sticks(const SquareMatrix& covariance,
                                           int count,
                                           unsigned seed) {
  const SquareMatrix root = root_of(covariance);
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal(0, std::sqrt(0.5));
  std::vector<IqSamples> sticks;
  for (int s = 0; s < count; ++s) {
    std::vector<std::complex<double>> white;
    for (int i = 0; i < root.size; ++i) white.emplace_back(normal(generator), normal(generator));
    IqSamples stick;
    for (int i = 0; i < root.size; ++i) {
      std::complex<double> sum = 0;
      for (int k = 0; k <= i; ++k) sum += root.at(i, k) * white[static_cast<std::size_t>(k)];
      stick.emplace_back(sum);
    }
    sticks.push_back(stick);
  }
  return sticks;
}

/// -log det R - z* R^-1 z.
inline double log_likelihood(const SquareMatrix& covariance, const IqSamples& stick) {
  const SquareMatrix root = root_of(covariance);
  std::vector<std::complex<double>> white;
  double value = 0;
  for (int i = 0; i < root.size; ++i) {
    std::complex<double> sum = stick[static_cast<std::size_t>(i)];
    for (int k = 0; k < i; ++k) sum -= root.at(i, k) * white[static_cast<std::size_t>(k)];
    white.push_back(sum / root.at(i, i));
    value -= 2 * std::log(root.at(i, i).real()) + std::norm(white.back());
  }
  return value;
}

/// A surface of unit tissue power at this contrast over the noise, with the default probe's pulse.
inline EdgeSignal test_signal(double contrast_db,
                              double rise_sigma_m = 0.2e-3,
                              decltype(&pulse_after_edge) order = &pulse_after_edge) {
  constexpr double kPulse_m = 0.137e-3;
  return {.noise_power = std::pow(10.0, -contrast_db / 10),
          .spacing_m = 0.156e-3,
          .pair = order(gaussian_correlation(kPulse_m),
                        gaussian_rise(std::hypot(rise_sigma_m, kPulse_m / std::sqrt(2.0))))};
}

}  // namespace wobblebench::bench
