// The IQ samples of a stick across a surface between fluid and tissue as a random process: complex
// Gaussian of zero mean (fully developed speckle and noise), with a covariance that depends on
// where the surface is; and the Fisher information of such samples about the surface's range.
#pragma once

#include <complex>
#include <cstddef>
#include <functional>
#include <vector>

namespace wobblebench::bench {

/// Row by row.
struct SquareMatrix {
  using Value = std::complex<double>;
  int size = 0;
  std::vector<Value> values;

  explicit SquareMatrix(int n) : size(n), values(static_cast<std::size_t>(n) * n) {}
  Value& at(int row, int column) { return values[static_cast<std::size_t>(row) * size + column]; }
  Value at(int row, int column) const {
    return values[static_cast<std::size_t>(row) * size + column];
  }
};

/// Fisher information tr(R^-1 dR R^-1 dR) of circular zero-mean samples of covariance R, given its
/// derivative by the parameter; both Hermitian. In the parameter's unit to the power -2; its
/// inverse bounds the variance of any unbiased estimate (Cramer and Rao; S. M. Kay, Fundamentals of
/// Statistical Signal Processing: Estimation Theory, chapters 3 and 15; docs/references.md [22]).
/// Throws std::domain_error where R is not positive definite.
double covariance_information(const SquareMatrix& covariance, const SquareMatrix& derivative);

/// The share of the beam's power that lies in the tissue, at a distance along the stick behind the
/// point where the axis meets the surface, and its derivative by that distance (1/m).
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
/// Takes two ranges `distance_m` >= 0 apart, whose middle lies `behind_m` behind the surface; the
/// value is the nearer one's sample times the farther one's, conjugated.
using EdgePair = std::function<PairValue(double behind_m, double distance_m)>;

/// Correlation of speckle in uniform tissue at two ranges `distance_m` apart; 1 at 0.
using SpeckleCorrelation = std::function<double(double distance_m)>;

/// The speckle correlation of a Gaussian pulse of this sigma of amplitude: exp(-(d / 2 sigma)^2).
SpeckleCorrelation gaussian_correlation(double pulse_sigma_m);

/// Scatterers that end at the surface, then the pulse: correlation(distance) rise(middle), exact
/// for a Gaussian pulse whose power is part of the rise.
EdgePair pulse_after_edge(SpeckleCorrelation correlation, EdgeRise rise);

/// Powers relative to any common one.
struct EdgeSignal {
  double tissue_power = 1;
  double fluid_power = 0;  ///< echo of the fluid: clutter
  double noise_power = 0;  ///< white, of each sample
  double spacing_m = 0;    ///< between samples
  EdgePair pair;
};

/// Covariance of the samples at first_m, first_m + spacing, ... for a surface at `edge_m` on the
/// stick.
struct EdgeCovariance {
  SquareMatrix value;
  SquareMatrix derivative;  ///< by the surface's range
};
EdgeCovariance edge_covariance(const EdgeSignal& signal,
                               double edge_m,
                               double first_m,
                               int samples);

}  // namespace wobblebench::bench
