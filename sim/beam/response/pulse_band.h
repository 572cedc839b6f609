// The band of the pulse, represented by a few frequencies: how a response that varies over the band
// becomes an echo.
//
// A response H(k) is interpolated by the polynomial through its values at the nodes of the Gauss
// rule whose weight is the pulse's power spectrum. The echo of unit pulse is then sum over nodes of
// H(k_i) phi_i(r), where phi_i is the transform of the node's Lagrange polynomial times the pulse's
// spectrum.
#pragma once

#include <array>
#include <complex>
#include <memory>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/beam/response/gauss_rule.h"

namespace wobblebench::sim {

/// Values of a response at a group of nodes: one SIMD register each.
struct alignas(32) BandValues {
  static constexpr int kNodes = 4;
  float re[kNodes] = {};
  float im[kNodes] = {};
};

/// Cheap to copy.
class PulseBand {
 public:
  /// Out of focus the response varies by several periods over the band.
  static constexpr int kNodes = 2 * BandValues::kNodes;
  /// No transducer sends lower frequencies, over the centre's; a wide Gaussian band would.
  static constexpr double kLowest = 0.2;
  using Values = std::array<std::complex<double>, kNodes>;

  explicit PulseBand(const hw::AcquisitionPlan& plan);

  static constexpr int nodes() { return kNodes; }
  /// Of BandValues.
  static constexpr int groups() { return kNodes / BandValues::kNodes; }
  /// Not of a band that is cut at kLowest: nodes lie symmetrically about the centre: their pulses
  /// come in conjugate pairs.
  bool symmetric() const { return rule_->low == -rule_->high; }
  /// The last node below the centre.
  int below_center() const;

  /// Sigma of the pulse's envelope over range.
  double sigma_m() const { return sigma_m_; }
  double center_per_m() const { return center_per_m_; }
  /// Wavenumber 2 pi f / c of a node, in ascending order. At least kLowest of the
  /// centre's.
  double wavenumber_per_m(int node) const { return center_per_m_ + offset_per_m(node); }
  /// Distance of a node from the centre of the band.
  double offset_per_m(int node) const;
  /// Share of a node in a mean over the pulse's power spectrum.
  double weight(int node) const { return rule_->gauss.weights()[static_cast<std::size_t>(node)]; }

  /// phi_i at a distance behind the echo's range, demodulated by the centre.
  std::complex<double> pulse(int node, double offset_m) const;
  /// Largest magnitude of the echo, and its energy over that of the pulse.
  double peak(const Values& response) const;
  double power(const Values& response) const;

 private:
  /// Over the band in units in which the pulse's amplitude spectrum is exp(-x^2 / 2).
  struct Rule {
    double low;
    double high;
    GaussRule gauss;
    std::vector<Values> pulses;  ///< phi_i at ranges about the echo's

    explicit Rule(double lowest);
    /// phi of all nodes, `x` sigmas of the pulse behind the echo's range.
    Values pulses_at(double x) const;

   private:
    struct Sample {
      double x;
      std::array<double, kNodes> share;  ///< of the spectrum, times the Lagrange polynomials
    };
    std::vector<Sample> samples_;
  };

  double sigma_m_;
  double center_per_m_;
  std::shared_ptr<const Rule> rule_;
};

}  // namespace wobblebench::sim
