// Size and level of speckle at the places of tests/yardstick/speckle.csv.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bench/studies/validate/statistics.h"
#include "bench/studies/validate/study_report.h"
#include "sim/options.h"

namespace wobblebench::bench {

enum class BeamDirection { axial, lateral, elevation };

struct SpeckleSizeInputs {
  hw::ProbePreset preset = hw::ProbePreset::standard;
  sim::Rung rung = sim::Rung::field;
  bool side_lobes = false;
  /// At least two, for the error. On the last stick speckle spans several lines of the grid, so
  /// that a seed has few independent samples.
  std::vector<std::uint64_t> seeds = seeds_from(1, 4);
  double half_window_m = 2.5e-3;  ///< of range, about each place
};

struct SpeckleWidth {
  double fwhm_m = 0;
  double level_db = 0;  ///< mean echo power over that of the material
  /// Standard error over the width, from the seeds' spread; itself uncertain: to be averaged over
  /// many places.
  double relative_error = 0;
};

/// Full width at half maximum of the autocovariance of the intensity of even tissue without losses,
/// one for each of `places`. Sticks are dense in the direction measured and sparse in the others.
std::vector<SpeckleWidth> measure_speckle_widths(BeamDirection direction,
                                                 const SpeckleSizeInputs& inputs,
                                                 std::span<const BeamRow> places);

struct SpeckleSize {
  std::vector<BeamComparison> places;  ///< level: that measured with the lateral width
  double relative_error[3] = {};       ///< of a width: root mean square over places, by direction
};
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
