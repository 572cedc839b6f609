// Envelopes of uniform tissue on a grid of sticks about one angle of the sector, and autocovariance
// of their intensity with its width.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "hw/probe/probe.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// Sticks by motor angle and stick angle; steps of both are equal.
struct SpeckleGrid {
  std::vector<double> theta_rad;  ///< of the lines
  int frames = 0;
  int samples = 0;
  double spacing_m = 0;       ///< sample k lies at range (k + 1/2) * spacing_m
  std::vector<float> values;  ///< [frame][line][sample]

  int lines() const { return static_cast<int>(theta_rad.size()); }
  double at(int frame, int line, int sample) const {
    return static_cast<double>(
        values[static_cast<std::size_t>((frame * lines() + line) * samples + sample)]);
  }
  /// First sample at or beyond a range.
  int sample_at(double range_m) const;
};

/// What is asked of a grid.
struct GridPlan {
  double theta_rad = 0;  ///< of its middle
  int lines = 1;
  double theta_step_rad = 0;
  int frames = 1;
  double phi_step_rad = 0;
  double depth_m = 0;
  int samples = 0;
};

/// Soft tissue everywhere, without losses. Rung `scatterers` computes these sticks alone; `field`,
/// which filters noise over a whole scan, a scan of the sector with these steps, of which the lines
/// nearest to the middle are taken. One grid for each of `plans`, whose steps, numbers and depths
/// are the same.
std::vector<SpeckleGrid> speckle_grids(hw::ProbePreset preset,
                                       const sim::SimulationOptions& options,
                                       const std::vector<GridPlan>& plans);

/// A step from one sample of a grid to another.
struct ScanStep {
  int frames = 0;
  int lines = 0;
  int samples = 0;
};

/// Ranges, and pairs of lines whose middle is nearer to the grid's than this.
struct ScanWindow {
  double from_m = 0;
  double to_m = 0;
  double about_middle_rad = HUGE_VAL;
};

/// Covariance of the intensities of all pairs in the window that lie `step` apart, over their
/// standard deviations; means are those of each pair of lines. NaN where there is no pair.
double intensity_correlation(const SpeckleGrid& grid,
                             const ScanWindow& window,
                             const ScanStep& step);

/// Mean intensity in the window, of the lines next to the grid's middle; NaN if there is none.
double mean_intensity(const SpeckleGrid& grid, const ScanWindow& window);

/// Full width at half maximum of a covariance that is 1 at lag 0 and `values[i]` at (i + 1) *
/// `lag_m`: between two lags as a Gaussian goes. Throws std::runtime_error where it does not fall
/// to half.
double autocovariance_fwhm_m(const std::vector<double>& values, double lag_m);

}  // namespace wobblebench::bench
