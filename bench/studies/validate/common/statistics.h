// Seeds, moments, least squares, widths, and distance from the Rayleigh distribution.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace wobblebench::bench {

/// first, first + 1, …
std::vector<std::uint64_t> seeds_from(std::uint64_t first, int count);

/// Sums for mean and variance.
struct Moments {
  double count = 0;
  double sum = 0;
  double squares = 0;

  void add(double value) {
    ++count;
    sum += value;
    squares += value * value;
  }
  void add(const Moments& other) {
    count += other.count;
    sum += other.sum;
    squares += other.squares;
  }
  double mean() const { return sum / count; }
  double mean_square() const { return squares / count; }
  double sigma() const;
  /// mean / sigma
  double snr() const { return mean() / sigma(); }
};

/// Largest distance between the distribution of an envelope and Rayleigh's, whose scale is taken
/// from the envelope's mean square.
double rayleigh_distance(std::vector<double> envelope);

/// Distance that a true Rayleigh envelope of `n` independent samples exceeds in 1 % of all cases.
/// The scale is estimated, so that Kolmogorov's table would be too lenient. A Rayleigh
/// envelope's square is exponential, so this is the table for exponentials of unknown mean:
/// Stephens, J. Am. Stat. Assoc. 69, 730 (1974), (D - 0.2/n)(sqrt n + 0.26 + 0.5/sqrt n) = 1.308.
double rayleigh_critical_distance(double n);

struct Line {
  double slope = 0;
  double intercept = 0;
};
/// Least squares; at least two different x.
Line fit_line(std::span<const double> x, std::span<const double> y);

/// Full width at half of the largest value, linear between samples. Throws
/// std::runtime_error where the values do not fall below half on both sides.
double full_width_at_half(std::span<const double> x, std::span<const double> y);

/// Peak of a sampled Gaussian, by the parabola through the logarithms of the three highest
/// neighbours.
struct Peak {
  double position = 0;  ///< in samples
  double value = 0;
};
Peak gaussian_peak(std::span<const double> y);

}  // namespace wobblebench::bench
