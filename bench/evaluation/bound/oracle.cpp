#include "bench/evaluation/bound/oracle.h"

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

/// Of each column.
Eigen::RowVectorXd log_likelihood(const SquareMatrix& covariance, const Eigen::MatrixXcd& columns) {
  // Row by row: seen by columns it is the transpose, which is the conjugate.
  const Eigen::LLT<Eigen::MatrixXcd> root(
      Eigen::Map<const Eigen::MatrixXcd>(covariance.values.data(), covariance.size, covariance.size)
          .conjugate());
  const Eigen::MatrixXcd white = root.matrixL().solve(columns);
  const double log_determinant = 2 * root.matrixLLT().diagonal().real().array().log().sum();
  return (-white.colwise().squaredNorm().array() - log_determinant).matrix();
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

std::vector<double> most_likely_edges_m(const EdgeSignal& signal,
                                        double first_m,
                                        const std::vector<IqSamples>& sticks,
                                        const SearchGrid& search) {
  if (sticks.empty()) return {};
  const Eigen::MatrixXcd columns = columns_of(sticks);
  Eigen::MatrixXd likelihood(search.places, columns.cols());
  for (int place = 0; place < search.places; ++place) {
    const double edge_m = search.low_m + place * search.step_m;
    const auto covariance =
        edge_covariance(signal, edge_m, first_m, static_cast<int>(columns.rows()));
    likelihood.row(place) = log_likelihood(covariance.value, columns);
  }
  std::vector<double> edges;
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    edges.push_back(search.low_m + vertex(likelihood.col(j)) * search.step_m);
  }
  return edges;
}

}  // namespace wobblebench::bench
