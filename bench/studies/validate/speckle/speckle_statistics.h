// Envelope of fully developed speckle against the Rayleigh distribution (references.md [7]), its
// level against tests/yardstick/speckle.csv, and its statistics over the number of scatterers in a
// resolution cell.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/studies/validate/common/statistics.h"
#include "bench/studies/validate/common/study_report.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// Sticks, frames and samples are about as far apart as the point spread is wide or more.
struct SpeckleInputs {
  hw::ProbePreset preset = hw::ProbePreset::standard;
  sim::Rung rung = sim::Rung::scatterers;
  bool side_lobes = false;
  double scatterers_per_cell = sim::SimulationOptions().scatterers_per_cell;
  double sector_fraction = 0;  ///< angle of the middle line over half the sector
  std::vector<std::uint64_t> seeds = seeds_from(1, 2);
  double from_m = 30e-3;  ///< range window
  double to_m = 150e-3;
  double step_m = 1e-3;
};

struct SpeckleResult {
  Moments envelope;   ///< over the root mean square of its line and range
  Moments intensity;  ///< its square
  struct Seed {
    double distance = 0;  ///< Kolmogorov-Smirnov, from Rayleigh
    long n = 0;
  };
  std::vector<Seed> seeds;
  std::vector<double> values;  ///< envelopes of all seeds, as above
  /// At the table's depths in the range window: only the level is measured.
  std::vector<BeamComparison> levels;

  int rejected() const;  ///< seeds whose distance exceeds the 1 % level
};

/// Tissue without losses.
SpeckleResult measure_speckle(const SpeckleInputs& inputs);

/// Mean power of speckle over that of the material: `power` of the linear envelope re a mirror. A
/// material's backscatter_db is a mean amplitude; of Rayleigh's, the mean power is 4 / pi of its
/// square.
double level_over_material_db(double power);

/// mean / sigma of a Rayleigh envelope, sqrt(pi / (4 - pi)) = 1.913.
double rayleigh_snr();

StudyReport speckle_statistics_report();

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
