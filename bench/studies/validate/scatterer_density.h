// Speckle statistics over the number of scatterers in a resolution cell.
#pragma once

#include <vector>

#include "bench/studies/validate/speckle_statistics.h"
#include "bench/studies/validate/study_report.h"

namespace wobblebench::bench {

struct DensityInputs {
  std::vector<double> per_cell = {1, 1.5, 2, 3, 5, 7, 10, 15, 20, 30};
  /// Ranges about the focus of the standard preset.
  SpeckleInputs speckle = {.from_m = 60e-3, .to_m = 90e-3};
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

/// Effective number of scatterers for a number in the product of the three -6 dB widths: in
/// Gaussian beams and pulses each direction contributes sqrt(2 pi) sigma = 1.064 FWHM.
double effective_scatterers(double per_cell);

/// mean / sigma of the intensity of N randomly (Poisson) placed scatterers: 1 / sqrt(1 + 1 / N).
double intensity_snr(double effective);
/// The same for the envelope of that intensity: K distribution of shape 2 N (Jakeman and Pusey
/// 1976).
double envelope_snr(double effective);

StudyReport scatterer_density_report();

}  // namespace wobblebench::bench
