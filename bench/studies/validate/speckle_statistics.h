// Envelope of fully developed speckle against the Rayleigh distribution (references.md [7]).
#pragma once

#include <cstdint>
#include <vector>

#include "base/units.h"
#include "bench/studies/validate/seeds.h"
#include "bench/studies/validate/statistics.h"
#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// Sticks, frames and samples are so far apart that no two share a resolution cell.
struct SpeckleInputs {
  std::vector<std::uint64_t> seeds = seeds_from(1, 10);
  /// As at the end of the published curves; with the simulator's default of 10 mean / sigma is 2 %
  /// below its limit (scatterer_density.h).
  double scatterers_per_cell = 30;
  hw::AcquisitionOptions acquisition = {
      .depth_m = 0.12, .fan_rad = 100 * kDegree, .sticks_per_frame = 24, .frames_per_volume = 20};
  double from_m = 60e-3;  ///< range window
  double to_m = 100e-3;
  double step_m = 1e-3;
};

struct SpeckleResult {
  Moments envelope;   ///< over the mean of the material table
  Moments intensity;  ///< its square
  struct Seed {
    double distance = 0;  ///< Kolmogorov-Smirnov, from Rayleigh
    long n = 0;
  };
  std::vector<Seed> seeds;
  std::vector<double> values;  ///< envelopes of all seeds, as above

  int rejected() const;  ///< seeds whose distance exceeds the 1 % level
};

/// Tissue without losses.
SpeckleResult measure_speckle(sim::Rung rung, const SpeckleInputs& inputs);

/// mean / sigma of a Rayleigh envelope, sqrt(pi / (4 - pi)) = 1.913.
double rayleigh_snr();

}  // namespace wobblebench::bench
