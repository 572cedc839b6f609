// Scores, front and knees.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>

#include "bench/studies/trade/trade_analysis.h"

namespace wobblebench::bench {

namespace {

constexpr double kLeastBend = 0.02;  // of the slope; less is a straight line within rounding

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

double geometric_mean(const std::vector<const TradeRecord*>& records, double TradeRecord::*time) {
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

TradeScore score_of(std::size_t point, const std::vector<const TradeRecord*>& records) {
  TradeScore score;
  score.point = point;
  score.volume_ratio = geometric_mean(records, &TradeRecord::volume_ratio);
  score.view_ratio = geometric_mean(records, &TradeRecord::view_ratio);
  score.volume_ms = geometric_mean(records, &TradeRecord::volume_ms);
  score.view_ms = geometric_mean(records, &TradeRecord::view_ms);
  for (std::size_t i = 0; i < trade_measure_names().size(); ++i) {
    score.measures.push_back(mean_interval(means_of_seeds(records, i)));
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

/// Of log P95 against log time.
double slope(const TradeScore& from, const TradeScore& to) {
  return std::log(to.p95_mm() / from.p95_mm()) / std::log(to.volume_ratio / from.volume_ratio);
}

/// Where P95 falls, as long as it does.
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

}  // namespace

double TradeScore::p95_mm() const {
  return measures[trade_measure("p95_mm")].mean;
}

double TradeScore::wrong_percent() const {
  return measures[trade_measure("missed_or_false_percent")].mean;
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

std::vector<std::size_t> trade_front(const std::vector<TradeScore>& scores) {
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    // A setting that finds nothing has no P95.
    if (!std::isfinite(scores[i].p95_mm())) continue;
    const bool beaten = std::any_of(scores.begin(), scores.end(), [&](const TradeScore& other) {
      return dominates(other, scores[i]);
    });
    if (!beaten) front.push_back(i);
  }
  std::sort(front.begin(), front.end(), [&](std::size_t a, std::size_t b) {
    return scores[a].volume_ratio < scores[b].volume_ratio;
  });
  return front;
}

std::vector<TradeKnee> trade_knees(const std::vector<TradeScore>& scores,
                                   const std::vector<std::size_t>& front) {
  std::vector<std::size_t> whole;
  std::ranges::copy_if(front, std::back_inserter(whole), [&](std::size_t i) {
    return scores[i].wrong_percent() <= kMostWrongPercent;
  });
  const std::vector<std::size_t> hull = lower_hull(scores, whole);
  std::vector<TradeKnee> knees;
  for (std::size_t i = 1; i + 1 < hull.size(); ++i) {
    const TradeKnee knee{hull[i],
                         -slope(scores[hull[i - 1]], scores[hull[i]]),
                         -slope(scores[hull[i]], scores[hull[i + 1]])};
    if (knee.gain_before - knee.gain_after > kLeastBend) knees.push_back(knee);
  }
  return knees;
}

}  // namespace wobblebench::bench
