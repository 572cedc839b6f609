// Fisher information of complex Gaussian samples about one parameter of their covariance: the bound
// on the variance of any unbiased estimate is its inverse (Cramer and Rao; S. M. Kay, Fundamentals
// of Statistical Signal Processing: Estimation Theory, chapters 3 and 15; docs/references.md [22]).
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace wobblebench::bench {

/// Row by row.
struct SquareMatrix {
  using Value = std::complex<double>;
  int size = 0;
  std::vector<Value> values;

  explicit SquareMatrix(int n) : size(n), values(static_cast<std::size_t>(n) * n) {}
  Value& at(int row, int column) { return values[static_cast<std::size_t>(row) * size + column]; }
  Value at(int row, int column) const {
    return values[static_cast<std::size_t>(row) * size + column];
  }
};

/// tr(R^-1 dR R^-1 dR) of circular zero-mean samples of covariance R, given its derivative by the
/// parameter; both Hermitian. In the parameter's unit to the power -2. Throws std::domain_error
/// where R is not positive definite.
double covariance_information(const SquareMatrix& covariance, const SquareMatrix& derivative);

/// The same for independent samples of these variances: the sum of (d log variance)^2. Intensities
/// of such samples are exponential and have the same information: their phase carries none.
double independent_information(std::span<const double> variance,
                               std::span<const double> derivative);

}  // namespace wobblebench::bench
