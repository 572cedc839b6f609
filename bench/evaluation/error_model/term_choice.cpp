#include "bench/evaluation/error_model/term_choice.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "base/statistics.h"
#include "base/units.h"

namespace wobblebench::bench {

namespace {

constexpr double kHuber = 2.0;
constexpr double kOfMedian = 1.4826;
/// On the diagonal, relative to it: terms that do not vary stay at 0.
constexpr double kRidge = 1e-9;
constexpr auto kTerms = static_cast<Eigen::Index>(kErrorTerms);

/// Normal equations of a part of the rows.
struct Sums {
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(kTerms, kTerms);
  Eigen::VectorXd with_error = Eigen::VectorXd::Zero(kTerms);
  double squares = 0;

  Sums& operator+=(const Sums& other) {
    products += other.products;
    with_error += other.with_error;
    squares += other.squares;
    return *this;
  }
  Sums& operator-=(const Sums& other) {
    products -= other.products;
    with_error -= other.with_error;
    squares -= other.squares;
    return *this;
  }
};

double scale_mm(const std::vector<ErrorRow>& rows) {
  std::vector<double> errors;
  errors.reserve(rows.size());
  for (const ErrorRow& row : rows) errors.push_back(std::abs(static_cast<double>(row.error_m)));
  return kOfMedian * quantile(std::move(errors), 0.5) / kMillimetre;
}

std::vector<Sums> sums_by_set(const std::vector<ErrorRow>& rows) {
  const double beyond_mm = kHuber * scale_mm(rows);
  std::vector<Sums> sets;
  for (const ErrorRow& row : rows) {
    if (static_cast<std::size_t>(row.set) >= sets.size()) sets.resize(row.set + 1);
    const double error_mm = static_cast<double>(row.error_m) / kMillimetre;
    const double weight = std::min(1.0, beyond_mm / std::max(std::abs(error_mm), 1e-12));
    const Eigen::VectorXd x =
        Eigen::Map<const Eigen::VectorXf>(row.pixel.x.data(), kTerms).cast<double>();
    Sums& sums = sets[static_cast<std::size_t>(row.set)];
    sums.products.noalias() += weight * x * x.transpose();
    sums.with_error += weight * error_mm * x;
    sums.squares += weight * error_mm * error_mm;
  }
  return sets;
}

/// Coefficients of the taken terms; 0 for the others.
Eigen::VectorXd solve(const Sums& sums, const TakenTerms& taken) {
  Eigen::MatrixXd products = sums.products;
  Eigen::VectorXd with_error = sums.with_error;
  for (Eigen::Index i = 0; i < kTerms; ++i) {
    if (taken[static_cast<std::size_t>(i)] && products(i, i) > 0) {
      products(i, i) *= 1 + kRidge;
      continue;
    }
    products.row(i).setZero();
    products.col(i).setZero();
    products(i, i) = 1;
    with_error[i] = 0;
  }
  return products.ldlt().solve(with_error);
}

/// Share of the fold's mean square that a fit to the rest leaves.
double left_of(const Sums& fold, const Sums& all, const TakenTerms& taken) {
  Sums rest = all;
  rest -= fold;
  const Eigen::VectorXd c = solve(rest, taken);
  const double left = fold.squares - 2 * c.dot(fold.with_error) + c.dot(fold.products * c);
  return fold.squares > 0 ? left / fold.squares : 1;
}

}  // namespace

TermChoice choose_terms(const std::vector<ErrorRow>& rows,
                        const std::vector<std::vector<int>>& folds) {
  TermChoice choice;
  choice.folds = static_cast<int>(folds.size());
  if (rows.empty() || folds.empty()) return choice;
  const std::vector<Sums> sets = sums_by_set(rows);
  Sums all;
  for (const Sums& set : sets) all += set;
  std::vector<Sums> held_out(folds.size());
  for (std::size_t i = 0; i < folds.size(); ++i) {
    for (const int set : folds[i]) {
      if (static_cast<std::size_t>(set) < sets.size()) held_out[i] += sets[set];
    }
  }
  const auto left_with = [&](const TakenTerms& taken) {
    double sum = 0;
    for (const Sums& fold : held_out) sum += left_of(fold, all, taken);
    return sum / static_cast<double>(held_out.size());
  };
  double left = 1;
  for (;;) {
    ChosenTerm best{kConstantTerm, left};
    for (std::size_t i = 0; i < kErrorTerms; ++i) {
      if (choice.taken[i]) continue;
      TakenTerms tried = choice.taken;
      tried[i] = true;
      const double left_now = left_with(tried);
      if (left_now < best.left) best = {static_cast<ErrorTerm>(i), left_now};
    }
    if (!(best.left < left - kLeastGain)) return choice;
    choice.taken[best.term] = true;
    choice.order.push_back(best);
    left = best.left;
  }
}

}  // namespace wobblebench::bench
