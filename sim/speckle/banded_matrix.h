// Symmetric and triangular matrices of lines that correlate with their neighbours only.
#pragma once

#include <cstddef>
#include <vector>

namespace wobblebench::sim {

/// The lower half of a symmetric matrix, or a lower triangular one, whose entries more than `band`
/// beside the diagonal are 0.
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

/// The Cholesky factor L of a covariance of unit variances, L L^T, with `noise_share` of each
/// variance added as white noise, without which it has no factor where lines are much denser than
/// they decorrelate. Weights at the end of the band that are small in all rows are left out. Rows
/// have unit norm.
BandedMatrix cholesky_factor(const BandedMatrix& covariance, double noise_share);

}  // namespace wobblebench::sim
