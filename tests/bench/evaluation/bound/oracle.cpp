#include "tests/bench/evaluation/bound/oracle.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace wobblebench::bench {

namespace {

Eigen::MatrixXcd columns_of(const std::vector<IqSamples>& sticks) {
  const auto rows = static_cast<Eigen::Index>(sticks.front().size());
  Eigen::MatrixXcd columns(rows, static_cast<Eigen::Index>(sticks.size()));
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    const IqSamples& stick = sticks[static_cast<std::size_t>(j)];
    for (Eigen::Index i = 0; i < rows; ++i) columns(i, j) = stick[static_cast<std::size_t>(i)];
  }
  return columns;
}

using Columns = Eigen::MatrixXcd;

/// Of each column, given the lower triangular root of their covariance.
template <class Root>
Eigen::RowVectorXd log_likelihood(const Root& root, const Eigen::RowVectorXd& squares) {
  return (-squares.array() - 2 * root.matrixLLT().diagonal().real().array().log().sum()).matrix();
}

Eigen::RowVectorXd log_likelihood(const SquareMatrix& covariance, const Columns& columns) {
  // Row by row: seen by columns it is the transpose, which is the conjugate.
  const Columns matrix =
      Eigen::Map<const Columns>(covariance.values.data(), covariance.size, covariance.size)
          .conjugate();
  if (!matrix.imag().isZero(0)) {
    const Eigen::LLT<Columns> root(matrix);
    return log_likelihood(root, root.matrixL().solve(columns).colwise().squaredNorm());
  }
  const Eigen::LLT<Eigen::MatrixXd> root(matrix.real());  // four times as fast
  const Eigen::MatrixXd re = root.matrixL().solve(columns.real());
  const Eigen::MatrixXd im = root.matrixL().solve(columns.imag());
  return log_likelihood(root, re.colwise().squaredNorm() + im.colwise().squaredNorm());
}

/// Of the maximum, in steps of the grid.
double vertex(const Eigen::VectorXd& values) {
  Eigen::Index at = 0;
  values.maxCoeff(&at);
  if (at == 0 || at == values.size() - 1) return static_cast<double>(at);
  const double before = values[at - 1], behind = values[at + 1];
  const double curvature = before - 2 * values[at] + behind;
  return static_cast<double>(at) + (curvature < 0 ? 0.5 * (before - behind) / curvature : 0);
}

}  // namespace

std::vector<double> most_likely_edges_m(const EdgeSignalAt& signal,
                                        double first_m,
                                        const std::vector<IqSamples>& sticks,
                                        const SearchGrid& search) {
  if (sticks.empty()) return {};
  const Eigen::MatrixXcd columns = columns_of(sticks);
  Eigen::MatrixXd likelihood(search.places, columns.cols());
  for (int place = 0; place < search.places; ++place) {
    const double edge_m = search.low_m + place * search.step_m;
    const auto covariance =
        edge_covariance(signal(edge_m), edge_m, first_m, static_cast<int>(columns.rows()));
    likelihood.row(place) = log_likelihood(covariance.value, columns);
  }
  std::vector<double> edges;
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    edges.push_back(search.low_m + vertex(likelihood.col(j)) * search.step_m);
  }
  return edges;
}

}  // namespace wobblebench::bench
