// The IQ samples of a stick across a surface between fluid and tissue, as a random process: complex
// Gaussian of zero mean (fully developed speckle and noise), with a covariance that depends on
// where the surface is.
#pragma once

#include <complex>
#include <functional>
#include <vector>

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

/// Covariance of the echo at two ranges, over the echo's power deep in the tissue, and its
/// derivative by the distance behind the surface (1/m).
struct PairValue {
  std::complex<double> covariance = 0;
  std::complex<double> slope_per_m = 0;
};
/// For two ranges `distance_m` >= 0 apart, whose middle lies `behind_m` behind the surface: the
/// nearer one's sample times the farther one's, conjugated.
using EdgePair = std::function<PairValue(double behind_m, double distance_m)>;

/// Of speckle in even tissue at two ranges so far apart; 1 at 0.
using SpeckleCorrelation = std::function<double(double distance_m)>;

/// The speckle correlation of a Gaussian pulse of this sigma of amplitude: exp(-(d / 2 sigma)^2).
SpeckleCorrelation gaussian_correlation(double pulse_sigma_m);

/// Scatterers that end at the surface, then the pulse: correlation(distance) rise(middle), exact
/// for a Gaussian pulse whose power is part of the rise.
EdgePair pulse_after_edge(SpeckleCorrelation correlation, EdgeRise rise);
/// Even speckle multiplied by the root of the mean power, as on the rung `field`.
EdgePair edge_after_pulse(SpeckleCorrelation correlation, EdgeRise rise);

/// Powers relative to any common one.
struct EdgeSignal {
  double tissue_power = 1;
  double fluid_power = 0;  ///< echo of the fluid: clutter
  double noise_power = 0;  ///< white, of each sample
  double spacing_m = 0;    ///< between samples
  EdgePair pair;
};

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
