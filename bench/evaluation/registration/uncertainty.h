// How certain fitted parameters are: intervals where the errors of neighbouring points are
// correlated, and which parameters the data can tell apart.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <utility>
#include <vector>

namespace wobblebench::bench {

/// What the points of one block contribute to the normal equations at the solution: the gradient of
/// the robust cost, and its Hessian without second derivatives of the residuals.
struct BlockSums {
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
};

/// Sums by block, of residuals with a Huber loss. Blocks are numbered from 0 in the order in which
/// they were first met.
class BlockAccumulator {
 public:
  /// `huber`: residual beyond which the loss is linear; residuals are in standard deviations.
  BlockAccumulator(int parameters, double huber) : parameters_(parameters), huber_(huber) {}

  /// Residual and its derivatives by the parameters. Points with the same key are one block.
  void add(std::int64_t key, double residual, const Eigen::VectorXd& derivatives);
  const std::vector<BlockSums>& blocks() const { return blocks_; }
  /// Over all blocks.
  Eigen::MatrixXd hessian() const;

 private:
  int parameters_;
  double huber_;
  std::vector<std::int64_t> keys_;  ///< sorted, with their blocks
  std::vector<std::size_t> slots_;
  std::vector<BlockSums> blocks_;
};

struct BootstrapResult {
  Eigen::VectorXd low;  ///< 2.5 % quantile of the replicates' changes
  Eigen::VectorXd high;
  Eigen::MatrixXd covariance;
};

inline constexpr int kBootstrapReplicates = 1000;

/// Block bootstrap (Künsch 1989; Davison and Hinkley, Bootstrap Methods, 1997, 8.2.3): as many
/// blocks as there are, drawn with replacement; of each draw the parameters that one Newton step
/// from the solution gives, exact where the problem is linear. `prior_precision`: diagonal of the
/// inverse covariance of zero-mean priors on the parameters, which are drawn too, so that what the
/// data do not show keeps its prior's spread. A parameter with a row of zeros in Hessian and prior
/// stays where it is. Deterministic in `seed`.
BootstrapResult bootstrap_blocks(const std::vector<BlockSums>& blocks,
                                 const Eigen::VectorXd& prior_precision,
                                 std::uint64_t seed = 1,
                                 int replicates = kBootstrapReplicates);

/// A combination of parameters that the data show less well than the priors do.
struct UnseenCombination {
  std::vector<int> parameters;  ///< those with more than a tenth of its squared length, in standard
                                ///< deviations of the priors
  double data_over_prior;       ///< its standard deviation from the data alone, in the prior's; > 1
};

struct Identifiability {
  std::vector<UnseenCombination> unseen;
  std::vector<std::pair<int, int>> correlated;  ///< pairs with |correlation| above kHighCorrelation
};

inline constexpr double kHighCorrelation = 0.95;

/// `information`: Fisher information of the data alone, without priors (its inverse is the
/// covariance of the parameters); `prior_sigma`: 0 where a parameter is held; `covariance`: that of
/// the fit. The combinations that are not determined are eigenvectors of the information in units
/// of the priors.
Identifiability identifiability(const Eigen::MatrixXd& information,
                                const Eigen::VectorXd& prior_sigma,
                                const Eigen::MatrixXd& covariance);

}  // namespace wobblebench::bench
