// Size and level of speckle at the points of tests/yardstick/speckle.csv, and how much the speckle
// of neighbouring lines and frames of the default scan correlates: tests/yardstick/neighbours.csv.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bench/studies/validate/common/statistics.h"
#include "bench/studies/validate/common/study_report.h"
#include "sim/options.h"

namespace wobblebench::bench {

struct SpeckleSizeInputs {
  hw::ProbePreset preset = hw::ProbePreset::standard;
  sim::Rung rung = sim::Rung::field;
  bool side_lobes = false;
  /// At least two, for the error. On the last stick speckle spans several lines of the grid, so
  /// that a seed has few independent samples.
  std::vector<std::uint64_t> seeds = seeds_from(1, 4);
  double half_window_m = 2.5e-3;  ///< of range, about each point
};

struct SpeckleSize {
  std::vector<BeamComparison> places;  ///< level: that measured with the lateral width
  /// Standard error of a width over the width: root mean square over the places, by direction.
  std::vector<double> relative_error;
};
/// Full widths at half maximum of the autocovariance of the intensity of uniform tissue without
/// losses. Sticks are dense in the direction measured and sparse in the others.
SpeckleSize measure_speckle_size(const SpeckleSizeInputs& inputs, std::span<const BeamRow> places);

struct NeighbourInputs {
  std::vector<std::uint64_t> seeds = seeds_from(1, 3);
  double half_window_m = 3e-3;  ///< of range, about each depth
};

/// Correlations of the intensity in the middle 16 lines, at the ranges of neighbour_rows().
std::vector<NeighbourRow> measure_neighbours(sim::Rung rung,
                                             bool side_lobes,
                                             const NeighbourInputs& inputs);

StudyReport speckle_size_report();

}  // namespace wobblebench::bench
