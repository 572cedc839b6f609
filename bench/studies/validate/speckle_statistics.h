// Envelope of fully developed speckle against the Rayleigh distribution (references.md [7]), and
// its level against tests/yardstick/speckle.csv.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/studies/validate/statistics.h"
#include "bench/studies/validate/study_report.h"
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

}  // namespace wobblebench::bench
