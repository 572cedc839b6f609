// The transmitted pulse: its length, its sampling, and its band, represented by a few frequencies.
//
// A response H(k) that varies over the band becomes an echo as follows. H is interpolated by the
// polynomial through its values at the nodes of the Gauss rule whose weight is the pulse's power
// spectrum. The echo of a unit pulse is then the sum over the nodes of H(k_i) phi_i(r), where phi_i
// is the transform of the node's Lagrange polynomial times the pulse's spectrum.
//
// Absorption that grows with frequency moves the spectrum down (sim/losses/losses.h). H is
// unchanged, and its polynomial is multiplied by the remaining spectrum.
#pragma once

#include <algorithm>
#include <array>
#include <complex>
#include <cstddef>
#include <memory>
#include <vector>

#include "hw/probe/acquisition_plan.h"

namespace wobblebench::sim {

/// Full width at half amplitude along the stick of a Gaussian pulse (docs/references.md [4, 5]):
/// (c/2) 0.8825 / (B f0).
double axial_fwhm_m(const hw::AcquisitionPlan& plan);
/// IQ samples per output sample: enough for the two-sided bandwidth of the pulse.
int iq_oversampling(const hw::AcquisitionPlan& plan);
/// Standard deviation of a Gaussian of this full width at half maximum: FWHM / 2.3548.
double sigma_of_fwhm(double fwhm);
/// Standard deviation of the power of a Gaussian amplitude response of this full width at half
/// maximum.
double power_sigma(double amplitude_fwhm);

/// The centre frequency of the pulses of a scene as a function of range, relative to the
/// transmitted one: absorption lowers it.
struct FrequencyCourse {
  /// A spectrum that ends at PulseBand::kLowest has its centre above this.
  static constexpr float kLowest = 0.4F;

  double step_m = 0;
  /// Values at ranges (i + 1/2) * step_m; the last one holds beyond. Empty: 1 at every range.
  std::vector<float> ratio;

  double at(double range_m) const {
    if (ratio.empty()) return 1;
    const auto i = static_cast<std::size_t>(std::max(0.0, range_m / step_m));
    return static_cast<double>(std::max(ratio[std::min(i, ratio.size() - 1)], kLowest));
  }
};

/// Gauss's rule of quadrature for the weight exp(-x^2) on an interval, and its interpolation. With
/// the weight it is exact for polynomials of degree 2 * nodes - 1. On the whole axis it is the
/// Gauss-Hermite rule (Abramowitz and Stegun, table 25.10).
class GaussRule {
 public:
  /// At most 16 nodes, on an interval that contains 0.
  GaussRule(double low, double high, int nodes);

  /// Ascending.
  const std::vector<double>& nodes() const { return nodes_; }
  /// Their sum is 1.
  const std::vector<double>& weights() const { return weights_; }
  /// Lagrange polynomial of a node at x: 1 at this node, 0 at the others.
  double lagrange(int node, double x) const;

 private:
  /// Orthonormal polynomials of degree 0 to nodes; the scale of the last one is arbitrary.
  std::vector<double> polynomials(double x) const;
  void find_recurrence(double low, double high, int nodes);
  /// Zero of the last polynomial, which changes its sign between `low` and `high`.
  double zero_between(double low, double high) const;

  /// p[n + 1] = ((x - alpha[n]) p[n] - beta[n] p[n - 1]) / beta[n + 1]
  std::vector<double> alpha_, beta_;
  std::vector<double> nodes_, weights_;
};

/// Values of a response at the nodes of the band: one AVX register each for the real and imaginary
/// parts.
struct alignas(64) BandValues {
  static constexpr int kNodes = 8;
  float re[kNodes] = {};
  float im[kNodes] = {};
};

/// Cheap to copy: copies share the tables.
class PulseBand {
 public:
  /// Out of focus the response varies by several periods over the band.
  static constexpr int kNodes = BandValues::kNodes;
  /// Lowest frequency of the band, relative to the centre frequency: a wide Gaussian spectrum would
  /// reach lower, but no transducer transmits there.
  static constexpr double kLowest = 0.2;
  using Values = std::array<std::complex<double>, kNodes>;

  explicit PulseBand(const hw::AcquisitionPlan& plan);

  static constexpr int nodes() { return kNodes; }
  /// True if the spectrum sent ends with a step, so that the ends of the pulse die out slowly.
  bool ends_with_step() const { return rule_->low == rule_->cut; }
  /// The last node below the centre frequency.
  int below_center() const;

  /// Standard deviation of the pulse's envelope over range.
  double sigma_m() const { return sigma_m_; }
  /// Wavenumber 2 pi f0 / c of the centre frequency.
  double center_per_m() const { return center_per_m_; }
  /// Wavenumber 2 pi f / c of a node, in ascending order; at least kLowest of the centre's.
  double wavenumber_per_m(int node) const { return center_per_m_ + offset_per_m(node); }
  /// Wavenumber of a node minus that of the centre frequency.
  double offset_per_m(int node) const;
  /// Weights of the nodes in a mean over the pulse's power spectrum, whose centre is at
  /// `frequency_ratio` of the transmitted centre frequency.
  std::array<double, kNodes> weights(double frequency_ratio = 1) const;
  double weight(int node) const { return rule_->gauss.weights()[static_cast<std::size_t>(node)]; }

  /// phi of all nodes, `offset_m` behind the echo's range, demodulated by the transmitted centre
  /// frequency. The echo of a flat response has a peak of 1. `frequency_ratio`: centre of the
  /// Gaussian, whose part below kLowest is left out; it may itself lie below.
  Values pulses(double offset_m, double frequency_ratio = 1) const;
  /// Equivalent length of the echo of a flat response: the integral of its power over range.
  double length_m(double frequency_ratio = 1) const;
  /// Largest magnitude of the echo.
  double peak(const Values& response) const;
  /// Energy of the echo relative to the energy of the pulse.
  double power(const Values& response, double frequency_ratio = 1) const;

 private:
  /// The band in units in which the pulse's amplitude spectrum is exp(-x^2 / 2).
  struct Rule {
    double low;
    double cut;
    GaussRule gauss;
    std::vector<Values> pulses;  ///< phi_i at ranges around the echo's

    /// `cut`: lower end of the band; a spectrum that absorption has lowered is 0 below it.
    Rule(double lowest, double cut);
    /// phi of all nodes, `x` standard deviations of the pulse behind the echo's range, for a
    /// spectrum whose centre is lower by `down`.
    Values pulses_at(double x, double down) const;
    /// PulseBand::length_m() in standard deviations of the pulse.
    double length(double down) const;

   private:
    struct Sample {
      double x;
      std::array<double, kNodes> share;  ///< spectrum times the Lagrange polynomial of each node
    };
    std::vector<Sample> samples_;  ///< equidistant
  };

  /// Shift of the spectrum's centre, in units of the rule.
  double down(double frequency_ratio) const {
    return (1 - frequency_ratio) * center_per_m_ * 2 * sigma_m_;
  }

  double sigma_m_;
  double center_per_m_;
  std::shared_ptr<const Rule> rule_;
};

}  // namespace wobblebench::sim
