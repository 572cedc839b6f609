// The oracle on sticks of the simulator, across a tilted plane: is the bound one, and can it be
// reached?
#pragma once

#include <cstdint>
#include <vector>

#include "sim/options.h"

namespace wobblebench::bench {

struct PlaneCell {
  sim::Rung rung = sim::Rung::field;  ///< field or scatterers
  double range_m = 75e-3;             ///< of the surface on the middle stick
  double incidence_rad = 0;           ///< there, at most 60 degrees
  bool across = false;                ///< tilted across the image plane instead of in it
  double noise_db = -95;
  double scatterers_per_cell = 12;
  std::vector<std::uint64_t> seeds;  ///< none: the bounds alone
};

/// Along the sticks; root mean squares over sticks and seeds.
struct PlaneBound {
  double bound_m = 0;       ///< detection_bound_m() of a lone stick
  double rung_bound_m = 0;  ///< the same information with the covariance that the rung makes
  double envelope_m = 0;    ///< envelope_bound_m() at the spacing of detected samples
  double oracle_rms_m = 0;
  double oracle_bias_m = 0;  ///< mean error; positive: too deep
  double ratio = 0;          ///< oracle_rms_m over bound_m, with its 95 % interval
  double ratio_low = 0;
  double ratio_high = 0;
  double rung_ratio = 0;  ///< oracle_rms_m over rung_bound_m
  int n = 0;              ///< sticks times seeds
};

/// Fifteen sticks 3 degrees apart, the default probe and sampling; soft tissue in fluid without
/// absorption and without the echo of the interface itself. The oracle knows the covariance of its
/// rung (`scatterers`: with the tabulated beam) and the plane's slope, and searches about the true
/// place. Throws std::invalid_argument for other rungs and for an incidence above 60 degrees.
PlaneBound measure_plane_bound(const PlaneCell& cell);

}  // namespace wobblebench::bench
