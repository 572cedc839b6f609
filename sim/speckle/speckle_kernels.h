// Filters that give white noise the correlation of speckle across frames. All frames have the same
// beam, so that one filter serves them; lines do not (sim/speckle/line_covariance.h).
#pragma once

#include <vector>

#include "sim/optics/beam_profile.h"

namespace wobblebench::sim {

/// By range and angle of the stick.
class SpeckleKernels {
 public:
  SpeckleKernels(const hw::AcquisitionPlan& plan, const SimulationOptions& options);

  int angles() const { return grid_.angles(); }
  /// The tabulated angle nearest to a stick's.
  int angle_of(double theta_rad) const;
  /// Taps from the middle on (the filter is symmetric), with the sum of squares of the whole
  /// filter 1, so that filtered white noise keeps its power.
  std::vector<float> taps(double range_m, int angle) const;
  /// Largest number of taps.
  int count() const { return count_; }

 private:
  BeamGrid grid_;
  std::vector<std::vector<double>> taps_;  ///< [range][angle]
  int count_ = 1;
};

/// Taps, from the middle on, of the symmetric filter of unit power whose autocorrelation is
/// `correlation` at lags 0, 1, ... (1 at lag 0), by the square root of its spectrum. Negative parts
/// of the spectrum, which no correlation has, are left out.
std::vector<double> taps_of_correlation(const std::vector<double>& correlation);

}  // namespace wobblebench::sim
