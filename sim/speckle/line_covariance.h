// How speckle correlates between the lines of a frame.
//
// Neighbouring lines receive echoes of the same scatterers with different phases. The covariance of
// their fields is the overlap of their two-way responses: the sum of h1 conj(h2) over scatterer
// positions and frequencies. Out of focus a beam is wide but its phase is curved, so that the
// speckle size remains that of the aperture (the van Cittert-Zernike theorem, docs/references.md
// [21]). Towards the array's end each line has an aperture of its own.
#pragma once

#include <cstddef>
#include <vector>

#include "sim/optics/probe_optics.h"

namespace wobblebench::sim {

/// The lower half of a symmetric matrix, or a lower triangular matrix, whose entries more than
/// `band` off the diagonal are 0: of lines that correlate with their neighbours only.
struct BandedMatrix {
  int rows = 0;
  int band = 0;
  std::vector<double> values;  ///< [row][lag]

  explicit BandedMatrix(int row_count = 0, int bandwidth = 0)
      : rows(row_count),
        band(bandwidth),
        values(static_cast<std::size_t>(row_count) * (static_cast<std::size_t>(bandwidth) + 1)) {}
  /// Entry (row, row - lag), for a lag from 0 to band.
  double& at(int row, int lag) { return values[index(row, lag)]; }
  double at(int row, int lag) const { return values[index(row, lag)]; }

 private:
  std::size_t index(int row, int lag) const {
    return static_cast<std::size_t>(row) * (static_cast<std::size_t>(band) + 1) +
           static_cast<std::size_t>(lag);
  }
};

/// The Cholesky factor L of a covariance with unit variances, L L^T. `noise_share` of each variance
/// is added as white noise; without it the covariance of lines much closer than their correlation
/// length has no factor. Weights at the end of the band that are small in all rows are left out.
/// Rows have unit norm.
BandedMatrix cholesky_factor(const BandedMatrix& covariance, double noise_share);

/// Equidistant sticks of one frame.
struct UniformLines {
  int count;
  double first_rad;
  double step_rad;  ///< positive where there are several lines

  /// All sticks of a frame.
  static UniformLines of(const hw::AcquisitionPlan& plan);
  /// The fewest lines over the same sector between which speckle can be interpolated, at most all
  /// of a frame's.
  static UniformLines needed(const ProbeOptics& optics);
};

class LineCovariance {
 public:
  LineCovariance(const ProbeOptics& optics, const UniformLines& lines);

  /// The real part of the covariance of fields of unit power at a range. The phase of a whole line
  /// has no effect on the envelope; phases are chosen so that the covariance of neighbours is real.
  /// A line that no element serves has no correlation with others.
  BandedMatrix at(double range_m) const;

 private:
  ProbeOptics optics_;
  UniformLines lines_;
  std::vector<StickAperture> apertures_;  ///< of each line
};

}  // namespace wobblebench::sim
