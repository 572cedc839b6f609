// The envelope of fully developed speckle, against Rayleigh's distribution (references.md [7]).
#pragma once

#include <cstdint>
#include <vector>

#include "base/units.h"
#include "bench/studies/validate/seeds.h"
#include "bench/studies/validate/statistics.h"
#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// Sticks, frames and samples lie so far apart that no two of them share a resolution cell.
struct SpeckleInputs {
  std::vector<std::uint64_t> seeds = seeds_from(1, 10);
  /// As many as the published curves end with. The default's ten are 2 % short of the limit, which
  /// the study of densities shows.
  double scatterers_per_cell = 30;
  hw::AcquisitionOptions acquisition = {
      .depth_m = 0.12, .fan_rad = 100 * kDegree, .sticks_per_frame = 24, .frames_per_volume = 20};
  double from_m = 60e-3;  ///< ranges that are looked at
  double to_m = 100e-3;
  double step_m = 1e-3;
};

struct SpeckleResult {
  Moments envelope;   ///< over the mean that the material table says
  Moments intensity;  ///< its square
  struct Seed {
    double distance = 0;  ///< of Kolmogorov and Smirnov, from Rayleigh
    long n = 0;
  };
  std::vector<Seed> seeds;
  std::vector<double> values;  ///< envelopes of all seeds, as above

  int rejected() const;  ///< seeds whose distance is beyond that of 1 %
};

/// Tissue without losses.
SpeckleResult measure_speckle(sim::Rung rung, const SpeckleInputs& inputs);

/// mean / sigma of a Rayleigh envelope, sqrt(pi / (4 - pi)) = 1.913.
double rayleigh_snr();

}  // namespace wobblebench::bench
