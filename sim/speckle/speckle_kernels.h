// The correlation of speckle across frames and along sticks, for the filters that give it to white
// noise. (Across lines: sim/speckle/line_covariance.h.)
#pragma once

#include <vector>

#include "sim/optics/beam_profile.h"

namespace wobblebench::sim {

/// Filter kernels across frames, by range and stick angle. All frames have the same beam, so that
/// one kernel serves them.
class SpeckleKernels {
 public:
  explicit SpeckleKernels(const ProbeOptics& optics);

  int angles() const { return grid_.angles(); }
  /// Index of the tabulated angle nearest to a stick's.
  int angle_of(double theta_rad) const;
  /// Taps from the middle on; the filter is symmetric. The sum of squares of the whole filter is 1,
  /// so that filtered white noise keeps its power.
  std::vector<float> taps(double range_m, int angle) const;
  /// Largest number of taps.
  int count() const { return count_; }

 private:
  BeamGrid grid_;
  std::vector<std::vector<double>> taps_;  ///< [range][angle]
  int count_ = 1;
};

/// Taps, from the middle on, of the symmetric filter of unit power whose autocorrelation is
/// `correlation` at lags 0, 1, ... (1 at lag 0), by the square root of its spectrum. Negative
/// values of the spectrum, which no autocorrelation has, are set to 0.
std::vector<double> taps_of_correlation(const std::vector<double>& correlation);

/// Length of speckle along a stick: that of the pulse where the beam passes all frequencies of the
/// band equally. Out of focus it does not: for uniform tissue each frequency is weighted by the
/// power that the middle stick's beam has there, so that the received band is narrower or wider
/// than the transmitted one.
class SpeckleLengths {
 public:
  explicit SpeckleLengths(const ProbeOptics& optics);

  /// Standard deviation over range of the echo amplitude's kernel; linear between tabulated ranges.
  double sigma_m(double range_m) const;

 private:
  double step_m_;
  std::vector<double> sigmas_m_;  ///< at multiples of step_m_, from 0 on
};

}  // namespace wobblebench::sim
