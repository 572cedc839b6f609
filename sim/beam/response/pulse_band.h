// The band of the pulse, represented by four frequencies: how a response that varies over the band
// becomes an echo.
//
// A response H(k) is interpolated by a cubic through its values at the nodes of the Gauss-Hermite
// rule whose weight is the pulse's power spectrum. The echo of unit pulse
// is then sum over nodes of H(k_i) phi_i(r), where phi_i is the transform of the node's Lagrange
// polynomial times the pulse's spectrum: a Gaussian times Hermite polynomials.
#pragma once

#include <array>
#include <complex>

#include "hw/probe/acquisition_plan.h"

namespace wobblebench::sim {

/// Values of a response at the nodes of the band.
struct alignas(32) BandValues {
  static constexpr int kNodes = 4;
  float re[kNodes] = {};
  float im[kNodes] = {};
};

class PulseBand {
 public:
  static constexpr int kNodes = BandValues::kNodes;
  /// No transducer sends lower frequencies, over the centre's; a wide Gaussian band would.
  static constexpr double kLowest = 0.2;
  using Values = std::array<std::complex<double>, kNodes>;

  explicit PulseBand(const hw::AcquisitionPlan& plan);

  /// Sigma of the pulse's envelope over range.
  double sigma_m() const { return sigma_m_; }
  double center_per_m() const { return center_per_m_; }
  /// Wavenumber 2 pi f / c of a node, in ascending order. At least kLowest of the
  /// centre's.
  double wavenumber_per_m(int node) const;
  /// Distance of a node from the centre of the band.
  double offset_per_m(int node) const;
  /// Share of a node in a mean over the pulse's power spectrum.
  static double weight(int node);

  /// phi_i at a distance behind the echo's range, demodulated by the centre.
  std::complex<double> pulse(int node, double offset_m) const;
  /// Largest magnitude of the echo, and its energy over that of the pulse.
  static double peak(const Values& response);
  static double power(const Values& response);

 private:
  double sigma_m_;
  double center_per_m_;
};

}  // namespace wobblebench::sim
