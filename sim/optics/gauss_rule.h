// Gauss's rule of quadrature for the weight exp(-x^2) on an interval, and its interpolation.
#pragma once

#include <vector>

namespace wobblebench::sim {

/// Exact, with the weight, for polynomials of degree 2 * nodes - 1. On the whole axis it is the
/// Gauss-Hermite rule (Abramowitz and Stegun, table 25.10).
class GaussRule {
 public:
  /// Few nodes (at most 16) on an interval about 0.
  GaussRule(double low, double high, int nodes);

  /// Ascending.
  const std::vector<double>& nodes() const { return nodes_; }
  /// Sum 1.
  const std::vector<double>& weights() const { return weights_; }
  /// Polynomial that is 1 at a node, and 0 at the others.
  double lagrange(int node, double x) const;

 private:
  /// Orthonormal polynomials of degree 0 to nodes; the last one's scale is of no matter.
  std::vector<double> polynomials(double x) const;
  void find_recurrence(double low, double high, int nodes);
  /// The zero of the last polynomial between two places about it.
  double zero_between(double low, double high) const;

  /// p[n + 1] = ((x - alpha[n]) p[n] - beta[n] p[n - 1]) / beta[n + 1]
  std::vector<double> alpha_, beta_;
  std::vector<double> nodes_, weights_;
};

}  // namespace wobblebench::sim
