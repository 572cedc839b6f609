#include "tests/bench/evaluation/bound/oracle.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

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

/// Log likelihood of each column, given the lower triangular root of their covariance.
template <class Root>
Eigen::RowVectorXd log_likelihood(const Root& root, const Eigen::RowVectorXd& squares) {
  return (-squares.array() - 2 * root.matrixLLT().diagonal().real().array().log().sum()).matrix();
}

Eigen::RowVectorXd log_likelihood(const SquareMatrix& covariance, const Columns& columns) {
  // Stored row by row: read by columns it is the transpose, which is the conjugate.
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

/// Position of the maximum, in steps of the grid.
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
  Eigen::MatrixXd likelihood(search.count, columns.cols());
  for (int i = 0; i < search.count; ++i) {
    const double edge_m = search.low_m + i * search.step_m;
    const auto covariance =
        edge_covariance(signal(edge_m), edge_m, first_m, static_cast<int>(columns.rows()));
    likelihood.row(i) = log_likelihood(covariance.value, columns);
  }
  std::vector<double> edges;
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    edges.push_back(search.low_m + vertex(likelihood.col(j)) * search.step_m);
  }
  return edges;
}

EdgePair edge_after_pulse(SpeckleCorrelation correlation, EdgeRise rise) {
  return [correlation = std::move(correlation), rise = std::move(rise)](
             double behind_m, double distance_m) -> PairValue {
    const RiseValue a = rise(behind_m - 0.5 * distance_m), b = rise(behind_m + 0.5 * distance_m);
    const double mean = std::sqrt(a.share * b.share), together = correlation(distance_m);
    if (mean == 0) return {};
    const double slope_per_m = 0.5 * (a.slope_per_m * b.share + b.slope_per_m * a.share) / mean;
    return {together * mean, together * slope_per_m};
  };
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

double envelope_bound_m(const DetectionConditions& conditions, double detected_spacing_m) {
  constexpr int kPhases = 4;  // of the surface between two samples, as in detection_bound_m()
  DetectionConditions detected = conditions;
  detected.sample_spacing_m = detected_spacing_m;
  const EdgeSignal signal = edge_signal(detected);
  const SampleWindow window = sample_window(detected);
  double sum = 0;
  for (int phase = 0; phase < kPhases; ++phase) {
    const double edge_m = (phase + 0.5) / kPhases * detected_spacing_m;
    const auto covariance = edge_covariance(signal, edge_m, window.first_m, window.count);
    std::vector<double> variance, derivative;
    for (int i = 0; i < window.count; ++i) {
      variance.push_back(covariance.value.at(i, i).real());
      derivative.push_back(covariance.derivative.at(i, i).real());
    }
    sum += 1 / independent_information(variance, derivative);
  }
  return std::sqrt(sum / kPhases);
}

}  // namespace wobblebench::bench
