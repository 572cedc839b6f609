// Which parameters of a fit the data can tell apart.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace wobblebench::bench {

/// A combination of parameters that the data show less well than the priors do.
struct UnseenCombination {
  std::vector<int> parameters;  ///< those with more than a tenth of its squared length
  Eigen::VectorXd direction;    ///< unit, in standard deviations of the priors
  double data_over_prior;       ///< its standard deviation from the data alone, in the prior's; > 1
};

struct Identifiability {
  std::vector<UnseenCombination> unseen;
  std::vector<std::pair<int, int>> correlated;  ///< pairs with |correlation| above kHighCorrelation
};

inline constexpr double kHighCorrelation = 0.95;

/// `information`: of the data alone, by parameter (its inverse: their covariance);
/// `prior_sigma`: 0 where a parameter is held; `covariance`: of the fit. The unseen are
/// eigenvectors of the information in units of the priors.
Identifiability identifiability(const Eigen::MatrixXd& information,
                                const Eigen::VectorXd& prior_sigma,
                                const Eigen::MatrixXd& covariance);

}  // namespace wobblebench::bench
