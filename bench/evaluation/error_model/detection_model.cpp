#include "bench/evaluation/error_model/detection_model.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>

#include <algorithm>
#include <cmath>

#include "base/statistics.h"
#include "base/units.h"
#include "bench/evaluation/registration/uncertainty.h"

namespace wobblebench::bench {

namespace {

constexpr double kHuber = 2.0;
constexpr double kLeastSpread_mm = 0.02;
/// The location of ln |N(0, 1)| as the Huber loss estimates it (its mean is -0.635): the spread is
/// that of a normal distribution whose residuals have it.
constexpr double kLogNormal = -0.5744;
/// Of coefficients in units of their terms: wide enough to leave data alone.
constexpr double kPriorSigma = 10;
/// A term with a smaller relative variance of its own, the others given, cannot be told from them.
constexpr double kLeastOwnVariance = 1e-6;

/// One row of a linear problem, already over its standard deviation.
struct LinearRow {
  Eigen::VectorXd x;
  double y = 0;
  std::int64_t block = 0;
};

/// x coefficients - y; residual and derivative without dual numbers: the problem is linear.
class LinearCost : public ceres::CostFunction {
 public:
  explicit LinearCost(const LinearRow& row) : row_(row) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(row.x.size()));
  }
  bool Evaluate(double const* const* parameters,
                double* residual,
                double** jacobians) const override {
    residual[0] = -row_.y;
    for (Eigen::Index i = 0; i < row_.x.size(); ++i) residual[0] += row_.x[i] * parameters[0][i];
    if (jacobians && jacobians[0]) {
      for (Eigen::Index i = 0; i < row_.x.size(); ++i) jacobians[0][i] = row_.x[i];
    }
    return true;
  }

 private:
  const LinearRow& row_;
};

/// Terms that are no combination of those before them.
std::vector<bool> independent_terms(const std::vector<LinearRow>& rows) {
  const Eigen::Index size = rows.front().x.size();
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(size, size);
  for (const LinearRow& row : rows) products += row.x * row.x.transpose();
  std::vector<bool> independent(static_cast<std::size_t>(size));
  // Cholesky, leaving out the columns that add nothing.
  for (Eigen::Index i = 0; i < size; ++i) {
    const double own = products(i, i);
    double before = 0;
    for (const LinearRow& row : rows) before += row.x[i] * row.x[i];
    independent[static_cast<std::size_t>(i)] = before > 0 && own > kLeastOwnVariance * before;
    if (!independent[static_cast<std::size_t>(i)]) continue;
    for (Eigen::Index j = i + 1; j < size; ++j) {
      const double factor = products(j, i) / own;
      for (Eigen::Index k = i; k < size; ++k) products(j, k) -= factor * products(i, k);
    }
  }
  return independent;
}

void zero_dependent(std::vector<LinearRow>& rows, const std::vector<bool>& independent) {
  for (LinearRow& row : rows) {
    for (Eigen::Index i = 0; i < row.x.size(); ++i) {
      if (!independent[static_cast<std::size_t>(i)]) row.x[i] = 0;
    }
  }
}

Eigen::VectorXd solve(const std::vector<LinearRow>& rows) {
  const auto size = rows.front().x.size();
  Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(size);
  ceres::HuberLoss loss(kHuber);
  ceres::Problem::Options shared;
  shared.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(shared);
  for (const LinearRow& row : rows) {
    problem.AddResidualBlock(new LinearCost(row), &loss, coefficients.data());
  }
  const ceres::Matrix stiffness = ceres::Matrix::Identity(size, size) / kPriorSigma;
  problem.AddResidualBlock(
      new ceres::NormalPrior(stiffness, ceres::Vector::Zero(size)), nullptr, coefficients.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return coefficients;
}

struct Fitted {
  Eigen::VectorXd value;
  BootstrapResult intervals;
  std::vector<bool> independent;
  int blocks = 0;
};

Fitted fit(std::vector<LinearRow> rows) {
  Fitted result;
  result.independent = independent_terms(rows);
  zero_dependent(rows, result.independent);
  result.value = solve(rows);
  BlockAccumulator sums(static_cast<int>(result.value.size()), kHuber);
  for (const LinearRow& row : rows) sums.add(row.block, row.x.dot(result.value) - row.y, row.x);
  result.blocks = static_cast<int>(sums.blocks().size());
  Eigen::VectorXd precision =
      Eigen::VectorXd::Constant(result.value.size(), 1 / (kPriorSigma * kPriorSigma));
  for (Eigen::Index i = 0; i < precision.size(); ++i) {
    if (!result.independent[static_cast<std::size_t>(i)]) precision[i] = 0;
  }
  result.intervals = bootstrap_blocks(sums.blocks(), precision);
  return result;
}

template <std::size_t N>
void read_terms(const Fitted& fitted, std::array<FittedTerm, N>& terms) {
  for (std::size_t i = 0; i < N; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (!fitted.independent[i]) continue;
    const double value = fitted.value[at];
    terms[i] = {value, value + fitted.intervals.low[at], value + fitted.intervals.high[at], true};
  }
}

/// Standard deviation of a normal distribution with the median of |error - bias|.
double robust_scale_mm(const std::vector<ErrorRow>& rows, const DetectionModel& model) {
  constexpr double kOfMedian = 1.4826;
  std::vector<double> left;
  left.reserve(rows.size());
  for (const ErrorRow& row : rows) {
    left.push_back(std::abs(static_cast<double>(row.error_m) - model.bias_m(row.pixel)));
  }
  const double scale_mm = kOfMedian * quantile(std::move(left), 0.5) / kMillimetre;
  return std::max(scale_mm, kLeastSpread_mm);
}

std::vector<LinearRow> bias_rows(const std::vector<ErrorRow>& rows,
                                 const TakenTerms& taken,
                                 const DetectionModel& model) {
  const double sigma_mm = robust_scale_mm(rows, model);
  std::vector<LinearRow> result;
  result.reserve(rows.size());
  for (const ErrorRow& row : rows) {
    Eigen::VectorXd x(static_cast<Eigen::Index>(kErrorTerms));
    for (std::size_t i = 0; i < kErrorTerms; ++i) {
      x[static_cast<Eigen::Index>(i)] =
          taken[i] ? static_cast<double>(row.pixel.x[i]) / sigma_mm : 0;
    }
    result.push_back({x, static_cast<double>(row.error_m) / kMillimetre / sigma_mm, row.block});
  }
  return result;
}

/// Logarithms of what the bias leaves.
std::vector<LinearRow> spread_rows(const std::vector<ErrorRow>& rows, const DetectionModel& model) {
  std::vector<LinearRow> result;
  result.reserve(rows.size());
  for (const ErrorRow& row : rows) {
    const auto terms = spread_terms(row.pixel);
    const double left_mm =
        std::abs(static_cast<double>(row.error_m) - model.bias_m(row.pixel)) / kMillimetre;
    Eigen::VectorXd x(static_cast<Eigen::Index>(kSpreadTerms));
    for (std::size_t i = 0; i < kSpreadTerms; ++i) x[static_cast<Eigen::Index>(i)] = terms[i];
    result.push_back({x, std::log(std::max(left_mm, kLeastSpread_mm)) - kLogNormal, row.block});
  }
  return result;
}

}  // namespace

std::array<double, kSpreadTerms> spread_terms(const PixelTerms& pixel) {
  return {1,
          std::hypot(static_cast<double>(pixel.x[kLateralTerm]),
                     static_cast<double>(pixel.x[kElevationTerm])),
          static_cast<double>(pixel.x[kContrastTerm]),
          static_cast<double>(pixel.x[kDepthTerm]) / 10};
}

const std::array<TermDescription, kSpreadTerms>& spread_term_descriptions() {
  static const std::array<TermDescription, kSpreadTerms> terms = {{
      {"log_constant", "ln mm", "on a surface across the stick at 75 mm, contrast 0"},
      {"log_beam", "1/mm", "beam width x sin(incidence), both directions"},
      {"log_contrast", "1", "samples behind less before the surface"},
      {"log_depth", "1/cm", "range less 75 mm"},
  }};
  return terms;
}

double DetectionModel::bias_m(const PixelTerms& pixel) const {
  double sum_mm = 0;
  for (std::size_t i = 0; i < kErrorTerms; ++i) {
    sum_mm += bias[i].value * static_cast<double>(pixel.x[i]);
  }
  return sum_mm * kMillimetre;
}

double DetectionModel::spread_m(const PixelTerms& pixel) const {
  const auto terms = spread_terms(pixel);
  double log_mm = 0;
  for (std::size_t i = 0; i < kSpreadTerms; ++i) log_mm += spread[i].value * terms[i];
  return std::exp(std::clamp(log_mm, -5.0, 5.0)) * kMillimetre;
}

DetectionModel fit_detection_model(const std::vector<ErrorRow>& rows, const TakenTerms& taken) {
  DetectionModel model;
  model.rows = static_cast<int>(rows.size());
  if (rows.size() < kErrorTerms) return model;
  read_terms(fit(bias_rows(rows, taken, model)), model.bias);
  const Fitted fitted = fit(bias_rows(rows, taken, model));
  read_terms(fitted, model.bias);
  read_terms(fit(spread_rows(rows, model)), model.spread);
  model.blocks = fitted.blocks;
  model.correlated = identifiability(Eigen::MatrixXd::Zero(kErrorTerms, kErrorTerms),
                                     Eigen::VectorXd::Zero(kErrorTerms),
                                     fitted.intervals.covariance)
                         .correlated;
  return model;
}

}  // namespace wobblebench::bench
