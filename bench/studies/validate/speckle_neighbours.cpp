#include "bench/studies/validate/speckle_neighbours.h"

#include "bench/studies/validate/autocovariance.h"
#include "bench/studies/validate/scan.h"

namespace wobblebench::bench {

std::vector<NeighbourRow> measure_neighbours(sim::Rung rung,
                                             bool side_lobes,
                                             const NeighbourInputs& inputs) {
  // The steps of the default scan, 64 lines over 77 degrees and 37 frames over 61; about its
  // middle.
  const GridPlan plan{0, 16, 77.0 / 63 * kDegree, 37, 61.0 / 36 * kDegree, 0.165, 1500};
  std::vector<NeighbourRow> rows = neighbour_rows();
  for (NeighbourRow& row : rows) row.line_correlation = row.frame_correlation = 0;
  const double share = 1 / static_cast<double>(inputs.seeds.size());
  for (const std::uint64_t seed : inputs.seeds) {
    auto options = lossless_envelope(rung, seed);
    options.side_lobes = side_lobes;
    const SpeckleGrid volume = speckle_grids(hw::ProbePreset::standard, options, {plan}).front();
    for (NeighbourRow& row : rows) {
      const ScanWindow window{row.range_m - inputs.half_window_m,
                              row.range_m + inputs.half_window_m};
      row.line_correlation += share * intensity_correlation(volume, window, {0, 1, 0});
      row.frame_correlation += share * intensity_correlation(volume, window, {1, 0, 0});
    }
  }
  return rows;
}

}  // namespace wobblebench::bench
