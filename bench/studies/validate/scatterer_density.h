// Speckle statistics over the number of scatterers in a resolution cell.
#pragma once

#include <vector>

#include "bench/studies/validate/speckle_statistics.h"

namespace wobblebench::bench {

struct DensityInputs {
  std::vector<double> per_cell = {1, 1.5, 2, 3, 5, 7, 10, 15, 20, 30};
  /// Ranges about the smallest resolution cell of the default probe, which `per_cell` counts.
  SpeckleInputs speckle = {.seeds = seeds_from(1, 3), .from_m = 66e-3, .to_m = 82e-3};
};

struct DensityPoint {
  double per_cell = 0;
  double effective = 0;  ///< number per sample, N = density (int h^2)^2 / int h^4
  double envelope_snr = 0;
  double envelope_error = 0;  ///< standard error, from the seeds' and the ranges' spread
  double intensity_snr = 0;
  double intensity_error = 0;
  long n = 0;
};
std::vector<DensityPoint> measure_density(const DensityInputs& inputs);

/// Effective number of scatterers for a density: in Gaussian beams and pulses each direction
/// contributes sqrt(2 pi) sigma = 1.064 FWHM. Mean over the range window.
double effective_scatterers(const DensityInputs& inputs, double per_cell);

/// mean / sigma of the intensity of N randomly (Poisson) placed scatterers: 1 / sqrt(1 + 1 / N).
double intensity_snr(double effective);
/// The same for the envelope of that intensity: K distribution of shape 2 N (Jakeman and Pusey
/// 1976).
double envelope_snr(double effective);

}  // namespace wobblebench::bench
