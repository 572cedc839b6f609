// What a trade shows: the front of time and error, its knees, and which settings matter.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/evaluation/seed_statistics.h"
#include "bench/studies/trade/trade_study.h"

namespace wobblebench::bench {

/// Of one scene or the mean of several. The times are geometric means over scenes and seeds.
struct TradeFigures : TradeTimes {
  /// For each of traded(): over seeds. Without a mean where a scene or a seed has no value, as one
  /// in which nothing is found.
  std::vector<MeanInterval> measures;

  double p95_mm() const;
  double wrong_percent() const;  ///< missed_or_false_percent
};

/// A point's means over its scenes, and each of these alone: a mean hides a scene that is bad.
struct TradeScore : TradeFigures {
  std::size_t point = 0;
  struct OnScene : TradeFigures {
    std::size_t scene = 0;  ///< number of the plan
  };
  std::vector<OnScene> scenes;

  /// The scene on which the measure is greatest, or not formed. Throws std::out_of_range for a
  /// measure that is not traded, and without scenes.
  const OnScene& worst(const Measure& measure) const;
};

/// The score of a point on these scenes and all seeds of the plan; none where a measurement is
/// missing or was refused.
std::optional<TradeScore> trade_score(const TradeWork& work,
                                      const TradeRecords& records,
                                      const std::vector<std::size_t>& scenes,
                                      std::size_t point);

/// Scores of the points that were measured on all of these scenes and all seeds of the plan.
std::vector<TradeScore> trade_scores(const TradeWork& work,
                                     const TradeRecords& records,
                                     const std::vector<std::size_t>& scenes);

/// The most of a picture that may be missed or false, percent, where settings are compared by P95:
/// a setting that finds only surfaces that are easy to detect would have the least P95.
inline constexpr double kMostWrongPercent = 5;

/// Misses and invents at most kMostWrongPercent on each of its scenes.
bool finds_surface(const TradeScore& score);

/// Numbers of the scores that no other beats or equals in time for a volume, P95 and what
/// is missed or false together, by time. Of the scores of finds_surface(); of all, where there is
/// none.
std::vector<std::size_t> trade_front(const std::vector<TradeScore>& scores);

/// A corner of the lower convex hull of log P95 against log time: more time beyond it buys less
/// than before it.
struct TradeKnee {
  std::size_t score = 0;
  /// How much P95 falls for each per cent of time, in per cent: up to here, and from here on.
  double gain_before = 0, gain_after = 0;
};

/// The knees, by time, without the ends of the hull. None where no point has
/// finds_surface(). `front`: the result of trade_front().
std::vector<TradeKnee> trade_knees(const std::vector<TradeScore>& scores,
                                   const std::vector<std::size_t>& front);

/// The quantity that an effect is a difference of.
enum class TradeResponse { log2_volume_ratio, p95_mm, missed_or_false_percent };
inline constexpr TradeResponse kTradeResponses[] = {TradeResponse::log2_volume_ratio,
                                                    TradeResponse::p95_mm,
                                                    TradeResponse::missed_or_false_percent};

/// The mean response of a level's points less that of all others, with the 95 % interval of two
/// independent means (Welch).
struct LevelEffect {
  std::size_t axis = 0, level = 0;
  MeanInterval effect;
};

/// Share of the response's variance over the points that goes with one axis, or with two beyond
/// what each does alone: omega squared (Hays), which is 0 on average where there is no effect. The
/// 95 % interval, share - half to share + half, is of a jackknife that leaves out groups of points.
struct VarianceShare {
  std::size_t axis = 0, other = 0;  ///< equal: the share of one axis
  double share = 0, half = 0;
};

std::vector<LevelEffect> level_effects(const TradeWork& work,
                                       const std::vector<TradeScore>& scores,
                                       TradeResponse response);

/// The shares of all axes, then those of all pairs of axes.
std::vector<VarianceShare> variance_shares(const TradeWork& work,
                                           const std::vector<TradeScore>& scores,
                                           TradeResponse response);

}  // namespace wobblebench::bench
