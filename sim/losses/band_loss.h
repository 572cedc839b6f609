// Attenuation of a pulse with a bandwidth: higher frequencies lose more, so its centre falls.
#pragma once

#include "hw/probe/probe.h"

namespace wobblebench::sim {

/// A Gaussian amplitude spectrum of standard deviation s about f0, after a loss exp(-n f / f0): it
/// keeps its width, its centre moves to f0 (1 - n s^2), s relative to f0, and its integral, the
/// echo's peak, is exp(-n + n^2 s^2 / 2). The loss is linear in frequency only within the band:
/// from where the centre reaches kLowest f0 it stays, and the level falls on along its tangent.
/// n is in nepers at f0 for the whole way, there and back.
class BandLoss {
 public:
  static constexpr double kLowest = 0.4;

  explicit BandLoss(const hw::ProbeOptions& probe);

  /// Squared relative standard deviation of the spectrum.
  double variance() const { return variance_; }
  /// Loss at which the centre reaches kLowest.
  double most_nepers() const { return most_nepers_; }
  /// Natural logarithm of the echo's peak over that of a pulse of the single frequency f0.
  double log_gain(double nepers) const;
  /// Centre frequency over f0.
  double frequency_ratio(double nepers) const;

 private:
  double variance_;
  double most_nepers_;
};

}  // namespace wobblebench::sim
