#include "bench/studies/trade/trade_analysis.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <random>
#include <utility>

#include "bench/results/error.h"

namespace wobblebench::bench {

namespace {

constexpr double kLeastBend = 0.02;  // change of slope at a knee; less is a straight line

/// The records of one point, or none where one is missing or was refused.
std::optional<std::vector<const TradeRecord*>> records_of(const TradeWork& work,
                                                          const TradeRecords& records,
                                                          const std::vector<std::size_t>& scenes,
                                                          std::size_t point) {
  std::vector<const TradeRecord*> found;
  for (const std::size_t scene : scenes) {
    for (std::size_t seed = 0; seed < work.plan.seeds.size(); ++seed) {
      const auto record = records.find({scene, point, seed});
      if (record == records.end() || !record->second.refused.empty()) return std::nullopt;
      found.push_back(&record->second);
    }
  }
  return found;
}

double geometric_mean(const std::vector<const TradeRecord*>& records, double TradeTimes::*time) {
  double sum = 0;
  for (const TradeRecord* record : records) sum += std::log(record->*time);
  return std::exp(sum / static_cast<double>(records.size()));
}

/// The mean of a measure over the scenes, for each seed.
std::vector<double> means_of_seeds(const std::vector<const TradeRecord*>& records,
                                   std::size_t measure) {
  std::map<std::size_t, std::vector<double>> by_seed;
  for (const TradeRecord* record : records) {
    by_seed[record->unit.seed].push_back(record->measures[measure]);
  }
  std::vector<double> means;
  for (const auto& [seed, values] : by_seed) {
    // Not finite where a scene has none.
    means.push_back(std::accumulate(values.begin(), values.end(), 0.0) /
                    static_cast<double>(values.size()));
  }
  return means;
}

/// None where a value is not formed: mean_interval() would leave out the seed.
MeanInterval interval_of_all(const std::vector<double>& values) {
  const bool whole = std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
  return mean_interval(whole ? values : std::vector<double>{});
}

TradeFigures figures_of(const std::vector<const TradeRecord*>& records) {
  TradeFigures figures;
  for (const auto& [measure, time] : kTradeTimes) figures.*time = geometric_mean(records, time);
  for (std::size_t i = 0; i < traded().size(); ++i) {
    figures.measures.push_back(interval_of_all(means_of_seeds(records, i)));
  }
  return figures;
}

TradeScore score_of(std::size_t point, const std::vector<const TradeRecord*>& records) {
  TradeScore score{{figures_of(records)}, point, {}};
  std::map<std::size_t, std::vector<const TradeRecord*>> by_scene;
  for (const TradeRecord* record : records) by_scene[record->unit.scene].push_back(record);
  for (const auto& [scene, of_scene] : by_scene) {
    score.scenes.push_back({{figures_of(of_scene)}, scene});
  }
  return score;
}

/// `a` is nowhere worse than `b`, and somewhere better.
bool dominates(const TradeScore& a, const TradeScore& b) {
  const bool no_worse = a.volume_ratio <= b.volume_ratio && a.p95_mm() <= b.p95_mm() &&
                        a.wrong_percent() <= b.wrong_percent();
  const bool better = a.volume_ratio < b.volume_ratio || a.p95_mm() < b.p95_mm() ||
                      a.wrong_percent() < b.wrong_percent();
  return no_worse && better;
}

/// Slope of log P95 against log time.
double slope(const TradeScore& from, const TradeScore& to) {
  return std::log(to.p95_mm() / from.p95_mm()) / std::log(to.volume_ratio / from.volume_ratio);
}

/// The lower convex hull, as far as P95 falls.
std::vector<std::size_t> lower_hull(const std::vector<TradeScore>& scores,
                                    const std::vector<std::size_t>& by_time) {
  std::vector<std::size_t> hull;
  for (const std::size_t next : by_time) {
    if (!hull.empty() && scores[next].p95_mm() >= scores[hull.back()].p95_mm()) continue;
    while (hull.size() >= 2 && slope(scores[hull[hull.size() - 2]], scores[hull.back()]) >=
                                   slope(scores[hull.back()], scores[next])) {
      hull.pop_back();
    }
    hull.push_back(next);
  }
  return hull;
}

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

/// Omega squared of the groups of equal levels of two axes; of one axis where `a` equals `b`.
double omega_squared(const std::vector<Observation>& all,
                     const std::vector<TradeAxis>& axes,
                     std::size_t a,
                     std::size_t b) {
  Moments total;
  std::vector<Moments> groups(axes[a].levels.size() * axes[b].levels.size());
  for (const Observation& one : all) {
    const auto at_a = static_cast<std::size_t>((*one.levels)[a]);
    const auto at_b = static_cast<std::size_t>((*one.levels)[b]);
    total.add(one.value);
    groups[at_a * axes[b].levels.size() + at_b].add(one.value);
  }
  double within = 0, used = 0;
  for (const Moments& group : groups) {
    within += group.deviation();
    if (group.n > 0) ++used;
  }
  const double between = total.deviation() - within;
  const double noise = within / std::max(1.0, total.n - used);
  const double whole = total.deviation() + noise;
  return whole > 0 ? (between - (used - 1) * noise) / whole : 0;
}

/// Shares of all axes, then of all pairs, without intervals.
std::vector<VarianceShare> point_shares(const std::vector<Observation>& all,
                                        const std::vector<TradeAxis>& axes) {
  std::vector<VarianceShare> shares;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    shares.push_back({a, a, omega_squared(all, axes, a, a), 0});
  }
  for (std::size_t a = 0; a < axes.size(); ++a) {
    for (std::size_t b = a + 1; b < axes.size(); ++b) {
      const double both = omega_squared(all, axes, a, b);
      shares.push_back({a, b, both - shares[a].share - shares[b].share, 0});
    }
  }
  return shares;
}

/// The group of each of `count` points, all groups of about one size.
std::vector<int> random_groups(std::size_t count, std::uint64_t seed) {
  std::vector<int> groups(count);
  for (std::size_t i = 0; i < count; ++i) groups[i] = static_cast<int>(i % kGroups);
  std::mt19937_64 random(seed);
  for (std::size_t i = count; i > 1; --i) std::swap(groups[i - 1], groups[random() % i]);
  return groups;
}

/// Standard deviation by estimates that each leave out one group.
double jackknife_deviation(const std::vector<double>& estimates) {
  Moments moments;
  for (const double estimate : estimates) moments.add(estimate);
  return std::sqrt(moments.deviation() * (moments.n - 1) / moments.n);
}

/// Standard deviation of an omega squared whose true value is 0: that of (F - 1) df / n. It is not
/// in the jackknife's, as the share is quadratic in the effects.
double deviation_of_nothing(const TradeWork& work, const VarianceShare& share, std::size_t n) {
  const auto freedom = [&](std::size_t axis) {
    return static_cast<double>(work.plan.axes[axis].levels.size() - 1);
  };
  const double df = freedom(share.axis) * (share.axis == share.other ? 1 : freedom(share.other));
  return std::sqrt(2 * df) / static_cast<double>(n);
}

}  // namespace

double TradeFigures::p95_mm() const {
  return measures[trade_measure(error::kP95.key)].mean;
}

double TradeFigures::wrong_percent() const {
  return measures[trade_measure(error::kMissedOrFalse.key)].mean;
}

const TradeScore::OnScene& TradeScore::worst(const Measure& measure) const {
  const std::size_t at = trade_measure(measure.key);
  const OnScene* worst = &scenes.at(0);
  for (const OnScene& one : scenes) {
    if (!std::isfinite(one.measures[at].mean)) return one;
    if (one.measures[at].mean > worst->measures[at].mean) worst = &one;
  }
  return *worst;
}

std::optional<TradeScore> trade_score(const TradeWork& work,
                                      const TradeRecords& records,
                                      const std::vector<std::size_t>& scenes,
                                      std::size_t point) {
  const auto found = records_of(work, records, scenes, point);
  return found ? std::optional(score_of(point, *found)) : std::nullopt;
}

std::vector<TradeScore> trade_scores(const TradeWork& work,
                                     const TradeRecords& records,
                                     const std::vector<std::size_t>& scenes) {
  std::vector<TradeScore> scores;
  for (std::size_t point = 0; point < work.points.size(); ++point) {
    const auto score = trade_score(work, records, scenes, point);
    if (score) scores.push_back(*score);
  }
  return scores;
}

bool finds_surface(const TradeScore& score) {
  return score.worst(error::kMissedOrFalse).wrong_percent() <= kMostWrongPercent;
}

std::vector<std::size_t> trade_front(const std::vector<TradeScore>& scores) {
  // A setting that finds nothing has no P95.
  std::vector<std::size_t> able, front;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (std::isfinite(scores[i].p95_mm())) able.push_back(i);
  }
  const auto within = [&](std::size_t i) { return finds_surface(scores[i]); };
  if (std::ranges::any_of(able, within)) std::erase_if(able, std::not_fn(within));
  for (const std::size_t i : able) {
    const bool beaten = std::ranges::any_of(
        able, [&](std::size_t other) { return dominates(scores[other], scores[i]); });
    if (!beaten) front.push_back(i);
  }
  std::sort(front.begin(), front.end(), [&](std::size_t a, std::size_t b) {
    return scores[a].volume_ratio < scores[b].volume_ratio;
  });
  return front;
}

std::vector<TradeKnee> trade_knees(const std::vector<TradeScore>& scores,
                                   const std::vector<std::size_t>& front) {
  if (front.empty() || !finds_surface(scores[front.front()])) return {};
  const std::vector<std::size_t> hull = lower_hull(scores, front);
  std::vector<TradeKnee> knees;
  for (std::size_t i = 1; i + 1 < hull.size(); ++i) {
    const TradeKnee knee{hull[i],
                         -slope(scores[hull[i - 1]], scores[hull[i]]),
                         -slope(scores[hull[i]], scores[hull[i + 1]])};
    if (knee.gain_before - knee.gain_after > kLeastBend) knees.push_back(knee);
  }
  return knees;
}

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
  std::vector<VarianceShare> result = point_shares(all, work.plan.axes);
  std::vector<std::vector<double>> without(result.size());
  const std::vector<int> groups = random_groups(all.size(), work.plan.design_seed);
  for (int group = 0; group < kGroups; ++group) {
    std::vector<Observation> left;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (groups[i] != group) left.push_back(all[i]);
    }
    const auto again = point_shares(left, work.plan.axes);
    for (std::size_t k = 0; k < result.size(); ++k) without[k].push_back(again[k].share);
  }
  for (std::size_t k = 0; k < result.size(); ++k) {
    result[k].half = kNormal95 * std::hypot(jackknife_deviation(without[k]),
                                            deviation_of_nothing(work, result[k], all.size()));
  }
  return result;
}

}  // namespace wobblebench::bench
