// Size of speckle: the autocorrelation of the intensity along the stick and across it.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/studies/validate/seeds.h"
#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::bench {

struct SpeckleSizeInputs {
  std::vector<double> ranges_m = {50e-3, 75e-3, 110e-3};
  double half_window_m = 5e-3;  ///< of range, about each of them
  std::vector<std::uint64_t> seeds = seeds_from(1, 2);
  int dense = 128;  ///< sticks, or frames, of the dense direction
  int sparse = 12;  ///< of the other
  bool side_lobes = true;
};

enum class BeamDirection { axial, lateral, elevation };

/// The normalised autocovariance of the intensity; 1 at lag 0.
struct Autocorrelation {
  double range_m = 0;
  std::vector<double> lag_m;
  std::vector<double> value;
  double fwhm_m = 0;      ///< of a Gaussian through its first lags: the full width at half maximum
  double expected_m = 0;  ///< see expected_speckle_m()
  long cells = 0;         ///< approximate number of resolution cells that were averaged
};

/// One for each range.
std::vector<Autocorrelation> measure_speckle_size(sim::Rung rung,
                                                  BeamDirection direction,
                                                  const SpeckleSizeInputs& inputs);

/// Width of the point spread's own autocorrelation, squared. For `field`, whose point spread is
/// Gaussian, it is the point spread's width at half amplitude (sim/beam/point_spread.h). For
/// `scatterers` across the stick: of the two-way response of the apertures
/// (sim/beam/beam_pattern.h), summed over the pulse's band.
double expected_speckle_m(sim::Rung rung,
                          BeamDirection direction,
                          const hw::AcquisitionPlan& plan,
                          double range_m);

}  // namespace wobblebench::bench
