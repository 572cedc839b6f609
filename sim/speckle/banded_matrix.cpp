#include "sim/speckle/banded_matrix.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::sim {

namespace {

constexpr double kSmallWeight = 0.003;  ///< 1e-5 of a row's power

/// The largest lag at which any row has a weight that counts.
int longest_lag(const BandedMatrix& factor) {
  int longest = 0;
  for (int row = 0; row < factor.rows; ++row) {
    for (int lag = factor.band; lag > longest; --lag) {
      if (std::abs(factor.at(row, lag)) >= kSmallWeight) longest = lag;
    }
  }
  return longest;
}

BandedMatrix with_unit_rows(const BandedMatrix& factor, int band) {
  BandedMatrix unit(factor.rows, band);
  for (int row = 0; row < factor.rows; ++row) {
    double power = 0;
    for (int lag = 0; lag <= band; ++lag) power += factor.at(row, lag) * factor.at(row, lag);
    for (int lag = 0; lag <= band; ++lag) {
      unit.at(row, lag) = factor.at(row, lag) / std::sqrt(power);
    }
  }
  return unit;
}

}  // namespace

BandedMatrix cholesky_factor(const BandedMatrix& covariance, double noise_share) {
  BandedMatrix factor(covariance.rows, covariance.band);
  for (int row = 0; row < factor.rows; ++row) {
    const int first = std::max(0, row - factor.band);
    for (int column = first; column <= row; ++column) {
      double rest = covariance.at(row, row - column) + (column == row ? noise_share : 0);
      for (int k = std::max(first, column - factor.band); k < column; ++k) {
        rest -= factor.at(row, row - k) * factor.at(column, column - k);
      }
      // Rounding alone makes a pivot smaller than the noise.
      factor.at(row, row - column) = column == row ? std::sqrt(std::max(rest, 0.5 * noise_share))
                                                   : rest / factor.at(column, 0);
    }
  }
  return with_unit_rows(factor, longest_lag(factor));
}

}  // namespace wobblebench::sim
