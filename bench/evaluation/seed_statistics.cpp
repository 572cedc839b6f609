#include "bench/evaluation/seed_statistics.h"

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

#include "base/statistics.h"

namespace wobblebench::bench {

namespace {

/// Both tails of the 95 % interval.
constexpr double kUpper = 0.975;
constexpr double kOneSided = 0.95;

}  // namespace

std::vector<std::uint64_t> seeds_from(std::uint64_t first, int count) {
  std::vector<std::uint64_t> seeds(static_cast<std::size_t>(count));
  std::iota(seeds.begin(), seeds.end(), first);
  return seeds;
}

MeanInterval mean_interval(const std::vector<double>& values) {
  MeanInterval result{0, kUnset, 0};
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    result.mean += value;
    ++result.n;
  }
  result.mean = result.n > 0 ? result.mean / result.n : kUnset;
  if (result.n < 2) return result;
  double squares = 0;
  for (const double value : values) {
    if (std::isfinite(value)) squares += (value - result.mean) * (value - result.mean);
  }
  const double error = std::sqrt(squares / (result.n - 1) / result.n);
  const boost::math::students_t_distribution<double> student(result.n - 1);
  result.half = boost::math::quantile(student, kUpper) * error;
  return result;
}

double upper_of_next(const MeanInterval& known) {
  if (known.n < 2) return std::numeric_limits<double>::infinity();
  const boost::math::students_t_distribution<double> student(known.n - 1);
  const double deviation = known.half / boost::math::quantile(student, kUpper) * std::sqrt(known.n);
  return known.mean +
         boost::math::quantile(student, kOneSided) * deviation * std::sqrt(1 + 1.0 / known.n);
}

MeanInterval paired_difference(const std::vector<double>& values,
                               const std::vector<double>& references) {
  if (values.size() != references.size()) {
    throw std::invalid_argument("paired_difference: " + std::to_string(values.size()) +
                                " values and " + std::to_string(references.size()) + " references");
  }
  std::vector<double> differences;
  for (std::size_t i = 0; i < values.size(); ++i) differences.push_back(values[i] - references[i]);
  return mean_interval(differences);
}

}  // namespace wobblebench::bench
