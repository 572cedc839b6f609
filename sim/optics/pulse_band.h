// The band of the pulse, represented by a few frequencies: how a response that varies over the band
// becomes an echo.
//
// A response H(k) is interpolated by the polynomial through its values at the nodes of the Gauss
// rule whose weight is the pulse's power spectrum. The echo of unit pulse is then sum over nodes of
// H(k_i) phi_i(r), where phi_i is the transform of the node's Lagrange polynomial times the pulse's
// spectrum.
//
// Absorption that grows with frequency moves the spectrum down (sim/losses/band_loss.h): H stays,
// and its polynomial is multiplied by the spectrum that is left.
#pragma once

#include <array>
#include <complex>
#include <memory>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/optics/gauss_rule.h"

namespace wobblebench::sim {

/// Values of a response at the nodes of the band: one AVX register each.
struct alignas(64) BandValues {
  static constexpr int kNodes = 8;
  float re[kNodes] = {};
  float im[kNodes] = {};
};

/// Cheap to copy.
class PulseBand {
 public:
  /// Out of focus the response varies by several periods over the band.
  static constexpr int kNodes = BandValues::kNodes;
  /// No transducer sends lower frequencies, over the centre's; a wide Gaussian band would.
  static constexpr double kLowest = 0.2;
  using Values = std::array<std::complex<double>, kNodes>;

  explicit PulseBand(const hw::AcquisitionPlan& plan);

  static constexpr int nodes() { return kNodes; }
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
  /// Shares of the nodes in a mean over the pulse's power spectrum, its centre at `frequency_ratio`
  /// of the one sent.
  std::array<double, kNodes> weights(double frequency_ratio = 1) const;
  double weight(int node) const { return rule_->gauss.weights()[static_cast<std::size_t>(node)]; }

  /// phi of all nodes at a distance behind the echo's range, demodulated by the centre sent. A
  /// flat response has a peak of 1; with a lower centre, less by what of the spectrum is below
  /// kLowest.
  Values pulses(double offset_m, double frequency_ratio = 1) const;
  /// Largest magnitude of the echo, and its energy over that of the pulse.
  double peak(const Values& response) const;
  double power(const Values& response, double frequency_ratio = 1) const;

 private:
  /// Over the band in units in which the pulse's amplitude spectrum is exp(-x^2 / 2).
  struct Rule {
    double low;
    double cut;
    GaussRule gauss;
    std::vector<Values> pulses;  ///< phi_i at ranges about the echo's

    /// `cut`: where the band ends, below which a spectrum that has fallen has nothing.
    Rule(double lowest, double cut);
    /// phi of all nodes, `x` sigmas of the pulse behind the echo's range, of a spectrum whose
    /// centre is `down` lower.
    Values pulses_at(double x, double down) const;

   private:
    struct Sample {
      double x;
      std::array<double, kNodes> share;  ///< of the spectrum, times the Lagrange polynomials
    };
    std::vector<Sample> samples_;  ///< evenly spaced
  };

  /// How far the spectrum's centre has fallen, in units of the rule.
  double down(double frequency_ratio) const {
    return (1 - frequency_ratio) * center_per_m_ * 2 * sigma_m_;
  }

  double sigma_m_;
  double center_per_m_;
  std::shared_ptr<const Rule> rule_;
};

}  // namespace wobblebench::sim
