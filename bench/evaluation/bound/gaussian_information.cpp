#include "bench/evaluation/bound/gaussian_information.h"

#include <Eigen/Cholesky>
#include <stdexcept>

namespace wobblebench::bench {

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::Map<const RowMajor> view(const SquareMatrix& matrix) {
  return {matrix.values.data(), matrix.size, matrix.size};
}

}  // namespace

double covariance_information(const SquareMatrix& covariance, const SquareMatrix& derivative) {
  const Eigen::LLT<Eigen::MatrixXd> root(view(covariance));
  if (root.info() != Eigen::Success) {
    throw std::domain_error("covariance_information: the covariance is not positive definite");
  }
  const Eigen::MatrixXd change = root.solve(Eigen::MatrixXd(view(derivative)));
  return change.cwiseProduct(change.transpose()).sum();
}

double independent_information(std::span<const double> variance,
                               std::span<const double> derivative) {
  double sum = 0;
  for (std::size_t i = 0; i < variance.size(); ++i) {
    const double relative = derivative[i] / variance[i];
    sum += relative * relative;
  }
  return sum;
}

}  // namespace wobblebench::bench
