#include "bench/evaluation/registration/identifiability.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace wobblebench::bench {

namespace {

/// Share of the squared length from which on a parameter belongs to a combination.
constexpr double kLeastShare = 0.1;

std::vector<int> main_parameters(const Eigen::VectorXd& direction) {
  std::vector<int> parameters;
  for (Eigen::Index i = 0; i < direction.size(); ++i) {
    if (direction[i] * direction[i] > kLeastShare) parameters.push_back(static_cast<int>(i));
  }
  return parameters;
}

/// One of the eigenvectors may be a held parameter itself.
bool is_held(const Eigen::VectorXd& direction, const Eigen::VectorXd& prior_sigma) {
  Eigen::Index largest = 0;
  direction.cwiseAbs().maxCoeff(&largest);
  return prior_sigma[largest] == 0;
}

}  // namespace

Identifiability identifiability(const Eigen::MatrixXd& information,
                                const Eigen::VectorXd& prior_sigma,
                                const Eigen::MatrixXd& covariance) {
  Identifiability result;
  const Eigen::MatrixXd scaled = prior_sigma.asDiagonal() * information * prior_sigma.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  for (Eigen::Index i = 0; i < scaled.rows(); ++i) {
    const double seen = std::max(0.0, solver.eigenvalues()[i]);
    const Eigen::VectorXd direction = solver.eigenvectors().col(i);
    if (seen >= 1 || is_held(direction, prior_sigma)) continue;
    const double ratio = seen > 0 ? 1 / std::sqrt(seen) : std::numeric_limits<double>::infinity();
    result.unseen.push_back({main_parameters(direction), direction, ratio});
  }
  for (int i = 0; i < covariance.rows(); ++i) {
    for (int j = i + 1; j < covariance.cols(); ++j) {
      const double scale = std::sqrt(covariance(i, i) * covariance(j, j));
      if (scale > 0 && std::abs(covariance(i, j)) > kHighCorrelation * scale) {
        result.correlated.emplace_back(i, j);
      }
    }
  }
  return result;
}

}  // namespace wobblebench::bench
