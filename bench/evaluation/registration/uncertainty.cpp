#include "bench/evaluation/registration/uncertainty.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/hash.h"
#include "base/statistics.h"
#include "sim/math/random.h"

namespace wobblebench::bench {

namespace {

/// Uniform and normal numbers in a fixed order.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : key_(mix64(seed + kGoldenGamma)) {}
  std::size_t below(std::size_t count) {
    return static_cast<std::size_t>(unit() * static_cast<double>(count));
  }
  /// Box-Muller.
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - unit()));
    return radius * std::cos(kTurn * unit());
  }

 private:
  static constexpr double kTurn = 6.283185307179586;
  /// Uniform in [0, 1).
  double unit() { return unit_interval(sim::uniform_bits(key_, next_++)); }

  std::uint64_t key_;
  std::uint64_t next_ = 0;
};

/// 1 on the diagonal where neither data nor prior say anything, so that the rest can be solved.
void fill_empty_rows(Eigen::MatrixXd& hessian) {
  for (Eigen::Index i = 0; i < hessian.rows(); ++i) {
    if (hessian(i, i) <= 0) hessian(i, i) = 1;
  }
}

Eigen::VectorXd one_replicate(const std::vector<BlockSums>& blocks,
                              const Eigen::VectorXd& prior_precision,
                              const Eigen::VectorXd& mean_gradient,
                              Draws& draws) {
  Eigen::MatrixXd hessian = prior_precision.asDiagonal();
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(prior_precision.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const BlockSums& drawn = blocks[draws.below(blocks.size())];
    hessian += drawn.hessian;
    // At the solution the gradients of data and priors cancel in sum, which is no scatter.
    gradient += drawn.gradient - mean_gradient;
  }
  for (Eigen::Index i = 0; i < gradient.size(); ++i) {
    gradient[i] += std::sqrt(prior_precision[i]) * draws.normal();
  }
  fill_empty_rows(hessian);
  return -hessian.ldlt().solve(gradient);
}

BootstrapResult summarise(const Eigen::MatrixXd& changes) {
  const Eigen::Index parameters = changes.rows();
  BootstrapResult result{Eigen::VectorXd(parameters), Eigen::VectorXd(parameters), {}};
  for (Eigen::Index i = 0; i < parameters; ++i) {
    std::vector<double> values(static_cast<std::size_t>(changes.cols()));
    for (Eigen::Index r = 0; r < changes.cols(); ++r) {
      values[static_cast<std::size_t>(r)] = changes(i, r);
    }
    result.low[i] = quantile(values, 0.025);
    result.high[i] = quantile(std::move(values), 0.975);
  }
  const Eigen::MatrixXd centred = changes.colwise() - changes.rowwise().mean();
  result.covariance = centred * centred.transpose() /
                      static_cast<double>(std::max<Eigen::Index>(1, changes.cols() - 1));
  return result;
}

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

void BlockAccumulator::add(std::int64_t key, double residual, const Eigen::VectorXd& derivatives) {
  const auto at = std::lower_bound(keys_.begin(), keys_.end(), key);
  const auto place = at - keys_.begin();
  if (at == keys_.end() || *at != key) {
    keys_.insert(at, key);
    slots_.insert(slots_.begin() + place, blocks_.size());
    blocks_.push_back(
        {Eigen::VectorXd::Zero(parameters_), Eigen::MatrixXd::Zero(parameters_, parameters_)});
  }
  BlockSums& block = blocks_[slots_[static_cast<std::size_t>(place)]];
  block.gradient += std::clamp(residual, -huber_, huber_) * derivatives;
  if (std::abs(residual) <= huber_) block.hessian += derivatives * derivatives.transpose();
}

Eigen::MatrixXd BlockAccumulator::hessian() const {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(parameters_, parameters_);
  for (const BlockSums& block : blocks_) sum += block.hessian;
  return sum;
}

BootstrapResult bootstrap_blocks(const std::vector<BlockSums>& blocks,
                                 const Eigen::VectorXd& prior_precision,
                                 std::uint64_t seed,
                                 int replicates) {
  Eigen::VectorXd mean_gradient = Eigen::VectorXd::Zero(prior_precision.size());
  for (const BlockSums& block : blocks) {
    mean_gradient += block.gradient / static_cast<double>(blocks.size());
  }
  Eigen::MatrixXd changes(prior_precision.size(), replicates);
  Draws draws(seed);
  for (int r = 0; r < replicates; ++r) {
    changes.col(r) = one_replicate(blocks, prior_precision, mean_gradient, draws);
  }
  return summarise(changes);
}

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
    result.unseen.push_back({main_parameters(direction), ratio});
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
