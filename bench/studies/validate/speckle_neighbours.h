// How much the speckle of neighbouring lines and frames of the default scan has in common:
// tests/yardstick/neighbours.csv.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/studies/validate/seeds.h"
#include "bench/studies/validate/yardstick.h"
#include "sim/options.h"

namespace wobblebench::bench {

struct NeighbourInputs {
  std::vector<std::uint64_t> seeds = seeds_from(1, 3);
  double half_window_m = 3e-3;  ///< of range, about each depth
};

/// Correlations of the intensity in the middle 16 lines, at the ranges of neighbour_rows().
std::vector<NeighbourRow> measure_neighbours(sim::Rung rung,
                                             bool side_lobes,
                                             const NeighbourInputs& inputs);

}  // namespace wobblebench::bench
