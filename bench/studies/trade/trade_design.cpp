// design_points(): which combinations of values a plan of `trade` has.
#include <algorithm>
#include <boost/random/sobol.hpp>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <stdexcept>

#include "base/hash.h"
#include "base/number_text.h"
#include "bench/studies/trade/trade_plan.h"

namespace wobblebench::bench {

namespace {

constexpr int kDigits = 4;

/// `share` in [0, 1) of the axis: the level that lies there, or the value of a range.
void add_value(const TradeAxis& axis, double share, TradePoint& point) {
  const auto count = static_cast<double>(axis.levels.size());
  const auto level = static_cast<std::size_t>(std::clamp(share * count, 0.0, count - 1));
  point.levels.push_back(static_cast<int>(level));
  if (!axis.range) {
    point.values.push_back(axis.levels[level]);
    return;
  }
  const TradeAxis::Range& range = *axis.range;
  const double value = range.logarithmic ? range.from * std::pow(range.to / range.from, share)
                                         : range.from + (range.to - range.from) * share;
  point.values.push_back(significant(value, kDigits));
}

/// The last axis runs fastest.
std::vector<TradePoint> grid(const TradePlan& plan) {
  std::vector<TradePoint> points(static_cast<std::size_t>(plan.points));
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::size_t block = points.size();
    for (const TradeAxis& axis : plan.axes) {
      block /= axis.levels.size();
      const std::size_t level = i / block % axis.levels.size();
      points[i].values.push_back(axis.levels[level]);
      points[i].levels.push_back(static_cast<int>(level));
    }
  }
  return points;
}

/// A whole number below `end`, the same with every standard library.
std::size_t below(std::mt19937_64& random, std::size_t end) {
  return static_cast<std::size_t>(random() % end);
}

std::vector<TradePoint> latin_hypercube(const TradePlan& plan) {
  std::mt19937_64 random(plan.design_seed);
  std::vector<TradePoint> points(static_cast<std::size_t>(plan.points));
  std::vector<std::size_t> order(points.size());
  for (const TradeAxis& axis : plan.axes) {
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[below(random, i)]);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double share = (static_cast<double>(order[i]) + 0.5) / static_cast<double>(plan.points);
      add_value(axis, share, points[i]);
    }
  }
  return points;
}

/// Shifted by a random vector, modulo 1, so that seeds differ.
std::vector<TradePoint> sobol(const TradePlan& plan) {
  boost::random::sobol sequence(plan.axes.size());
  std::mt19937_64 random(plan.design_seed);
  std::vector<double> shifts(plan.axes.size());
  std::generate(shifts.begin(), shifts.end(), [&] { return unit_interval(random()); });
  std::vector<TradePoint> points(static_cast<std::size_t>(plan.points));
  for (TradePoint& point : points) {
    for (std::size_t i = 0; i < plan.axes.size(); ++i) {
      const double share = unit_interval(sequence()) + shifts[i];
      add_value(plan.axes[i], share - std::floor(share), point);
    }
  }
  return points;
}

double share_of(const TradeAxis& axis, const std::string& value, int level) {
  if (!axis.range) return (level + 0.5) / static_cast<double>(axis.levels.size());
  const TradeAxis::Range& range = *axis.range;
  const double number = std::stod(value);
  const double share = range.logarithmic
                           ? std::log(number / range.from) / std::log(range.to / range.from)
                           : (number - range.from) / (range.to - range.from);
  return std::clamp(share, 0.0, 1.0);
}

}  // namespace

TradePoint point_at(const TradePlan& plan, const std::vector<double>& shares) {
  if (shares.size() != plan.axes.size()) throw std::invalid_argument("point_at: a share an axis");
  TradePoint point;
  for (std::size_t i = 0; i < shares.size(); ++i) add_value(plan.axes[i], shares[i], point);
  return point;
}

std::vector<double> shares_of(const TradePlan& plan, const TradePoint& point) {
  std::vector<double> shares;
  for (std::size_t i = 0; i < plan.axes.size(); ++i) {
    shares.push_back(share_of(plan.axes[i], point.values[i], point.levels[i]));
  }
  return shares;
}

std::vector<TradePoint> design_points(const TradePlan& plan) {
  switch (plan.design) {
    case TradeDesign::grid:
      return grid(plan);
    case TradeDesign::latin_hypercube:
      return latin_hypercube(plan);
    case TradeDesign::sobol:
      break;
  }
  return sobol(plan);
}

}  // namespace wobblebench::bench
