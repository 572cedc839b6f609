// Which settings matter: effects of levels, shares of variance.
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <utility>

#include "bench/studies/trade/trade_analysis.h"

namespace wobblebench::bench {

namespace {

constexpr int kGroups = 20;         // of the jackknife
constexpr double kNormal95 = 1.96;  // the groups of a trade are large

double response_of(const TradeScore& score, TradeResponse response) {
  switch (response) {
    case TradeResponse::log2_volume_ratio:
      return std::log2(score.volume_ratio);
    case TradeResponse::p95_mm:
      return score.p95_mm();
    case TradeResponse::missed_or_false_percent:
      break;
  }
  return score.wrong_percent();
}

/// A point's response and its levels.
struct Observation {
  double value = 0;
  const std::vector<int>* levels = nullptr;
};

/// Points that have the response.
std::vector<Observation> observations(const TradeWork& work,
                                      const std::vector<TradeScore>& scores,
                                      TradeResponse response) {
  std::vector<Observation> all;
  for (const TradeScore& score : scores) {
    const double value = response_of(score, response);
    if (std::isfinite(value)) all.push_back({value, &work.points[score.point].levels});
  }
  return all;
}

struct Moments {
  double n = 0, sum = 0, squares = 0;

  void add(double value) {
    ++n;
    sum += value;
    squares += value * value;
  }
  double mean() const { return sum / n; }
  /// Sum of squared deviations from the mean.
  double deviation() const { return n > 0 ? std::max(0.0, squares - sum * sum / n) : 0; }
  double variance_of_mean() const { return deviation() / (n - 1) / n; }
};

/// Omega squared of a grouping.
double omega_squared(const std::vector<Observation>& all,
                     std::size_t groups,
                     const std::function<std::size_t(const Observation&)>& group_of) {
  Moments total;
  std::vector<Moments> parts(groups);
  for (const Observation& one : all) {
    total.add(one.value);
    parts[group_of(one)].add(one.value);
  }
  double within = 0, used = 0;
  for (const Moments& part : parts) {
    within += part.deviation();
    if (part.n > 0) ++used;
  }
  const double between = total.deviation() - within;
  const double noise = within / std::max(1.0, total.n - used);
  const double whole = total.deviation() + noise;
  return whole > 0 ? (between - (used - 1) * noise) / whole : 0;
}

/// Shares of all axes, then of all pairs, from one set of observations.
class Shares {
 public:
  explicit Shares(const TradeWork& work) : axes_(work.plan.axes) {}

  std::vector<VarianceShare> of(const std::vector<Observation>& all) const {
    std::vector<VarianceShare> shares;
    for (std::size_t a = 0; a < axes_.size(); ++a) shares.push_back({a, a, alone(all, a), 0});
    for (std::size_t a = 0; a < axes_.size(); ++a) {
      for (std::size_t b = a + 1; b < axes_.size(); ++b) {
        shares.push_back({a, b, together(all, a, b) - shares[a].share - shares[b].share, 0});
      }
    }
    return shares;
  }

 private:
  static std::size_t level(const Observation& one, std::size_t axis) {
    return static_cast<std::size_t>((*one.levels)[axis]);
  }
  double alone(const std::vector<Observation>& all, std::size_t a) const {
    return omega_squared(
        all, axes_[a].levels.size(), [a](const Observation& one) { return level(one, a); });
  }
  double together(const std::vector<Observation>& all, std::size_t a, std::size_t b) const {
    const std::size_t stride = axes_[b].levels.size();
    return omega_squared(
        all, axes_[a].levels.size() * stride, [a, b, stride](const Observation& one) {
          return level(one, a) * stride + level(one, b);
        });
  }

  const std::vector<TradeAxis>& axes_;
};

/// The group of each of `count` points, all groups of about one size.
std::vector<int> random_groups(std::size_t count, std::uint64_t seed) {
  std::vector<int> groups(count);
  for (std::size_t i = 0; i < count; ++i) groups[i] = static_cast<int>(i % kGroups);
  std::mt19937_64 random(seed);
  for (std::size_t i = count; i > 1; --i) std::swap(groups[i - 1], groups[random() % i]);
  return groups;
}

/// Of estimates that each leave out one group.
double jackknife_deviation(const std::vector<double>& estimates) {
  Moments moments;
  for (const double estimate : estimates) moments.add(estimate);
  return std::sqrt(moments.deviation() * (moments.n - 1) / moments.n);
}

/// Deviation of an omega squared that is truly 0: that of (F - 1) df / n. The jackknife sees none
/// of it, as the share is quadratic in the effects.
double deviation_of_nothing(const TradeWork& work, const VarianceShare& share, std::size_t n) {
  const auto freedom = [&](std::size_t axis) {
    return static_cast<double>(work.plan.axes[axis].levels.size() - 1);
  };
  const double df = freedom(share.axis) * (share.axis == share.other ? 1 : freedom(share.other));
  return std::sqrt(2 * df) / static_cast<double>(n);
}

}  // namespace

std::vector<LevelEffect> level_effects(const TradeWork& work,
                                       const std::vector<TradeScore>& scores,
                                       TradeResponse response) {
  const auto all = observations(work, scores, response);
  std::vector<LevelEffect> effects;
  for (std::size_t axis = 0; axis < work.plan.axes.size(); ++axis) {
    for (std::size_t level = 0; level < work.plan.axes[axis].levels.size(); ++level) {
      Moments with, others;
      for (const Observation& one : all) {
        const bool is_with = (*one.levels)[axis] == static_cast<int>(level);
        (is_with ? with : others).add(one.value);
      }
      const double half =
          kNormal95 * std::sqrt(with.variance_of_mean() + others.variance_of_mean());
      effects.push_back(
          {axis, level, {with.mean() - others.mean(), half, static_cast<int>(with.n)}});
    }
  }
  return effects;
}

std::vector<VarianceShare> variance_shares(const TradeWork& work,
                                           const std::vector<TradeScore>& scores,
                                           TradeResponse response) {
  const auto all = observations(work, scores, response);
  const Shares shares(work);
  std::vector<VarianceShare> result = shares.of(all);
  std::vector<std::vector<double>> without(result.size());
  const std::vector<int> groups = random_groups(all.size(), work.plan.design_seed);
  for (int group = 0; group < kGroups; ++group) {
    std::vector<Observation> left;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (groups[i] != group) left.push_back(all[i]);
    }
    const auto again = shares.of(left);
    for (std::size_t k = 0; k < result.size(); ++k) without[k].push_back(again[k].share);
  }
  for (std::size_t k = 0; k < result.size(); ++k) {
    result[k].half = kNormal95 * std::hypot(jackknife_deviation(without[k]),
                                            deviation_of_nothing(work, result[k], all.size()));
  }
  return result;
}

}  // namespace wobblebench::bench
