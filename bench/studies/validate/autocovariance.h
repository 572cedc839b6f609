// Autocovariance of the intensity of speckle, and its width.
#pragma once

#include <cmath>
#include <vector>

#include "bench/studies/validate/speckle_grid.h"

namespace wobblebench::bench {

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
