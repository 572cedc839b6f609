// The IQ samples of a stick across a surface between fluid and tissue, as a random process: complex
// Gaussian of zero mean (fully developed speckle and noise), with a covariance that depends on
// where the surface is.
#pragma once

#include <functional>

#include "bench/evaluation/bound/gaussian_information.h"

namespace wobblebench::bench {

/// The share of the beam's power that lies in the tissue, at a distance along the stick behind the
/// place where the axis meets the surface, and its derivative by that distance (1/m).
struct RiseValue {
  double share = 0;
  double slope_per_m = 0;
};
using EdgeRise = std::function<RiseValue(double behind_m)>;

/// The rise of a beam whose power is Gaussian across an oblique plane.
EdgeRise gaussian_rise(double sigma_m);

/// What comes first.
enum class SpeckleOrder {
  pulse_after_edge,  ///< scatterers end at the surface, then the pulse passes (rung `scatterers`)
  edge_after_pulse   ///< even speckle, multiplied by the root of the mean power (rung `field`)
};

/// Powers relative to any common one.
struct EdgeSignal {
  double tissue_power = 1;
  double fluid_power = 0;  ///< echo of the fluid: clutter
  double noise_power = 0;  ///< white, of each sample
  double spacing_m = 0;    ///< between samples
  /// Of the speckle of even tissue at two ranges so far apart; 1 at 0.
  std::function<double(double distance_m)> correlation;
  /// With the pulse's power included.
  EdgeRise rise;
  SpeckleOrder order = SpeckleOrder::pulse_after_edge;
};

/// The speckle correlation of a Gaussian pulse of this sigma of amplitude: exp(-(d / 2 sigma)^2).
std::function<double(double)> gaussian_correlation(double pulse_sigma_m);

/// Of the samples at first_m, first_m + spacing, ..., for a surface at `edge_m` on the stick.
struct EdgeCovariance {
  SquareMatrix value;
  SquareMatrix derivative;  ///< by the surface's place
};
EdgeCovariance edge_covariance(const EdgeSignal& signal,
                               double edge_m,
                               double first_m,
                               int samples);

/// The mean power of those samples, and its derivative by the surface's place.
struct EdgePower {
  std::vector<double> value;
  std::vector<double> derivative;
};
EdgePower edge_power(const EdgeSignal& signal, double edge_m, double first_m, int samples);

}  // namespace wobblebench::bench
