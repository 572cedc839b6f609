// What a trade shows: the front of time and error, its knees, and which settings matter.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/evaluation/seed_statistics.h"
#include "bench/studies/trade/trade_study.h"

namespace wobblebench::bench {

/// A point over its scenes and seeds. The times are geometric means.
struct TradeScore : TradeTimes {
  std::size_t point = 0;
  std::vector<MeanInterval> measures;  ///< for each of traded(): over seeds

  double p95_mm() const;
  double wrong_percent() const;  ///< missed_or_false_percent
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

/// Numbers of the scores that no other beats or equals in time for a volume, P95 and what
/// is missed or false together, by time.
std::vector<std::size_t> trade_front(const std::vector<TradeScore>& scores);

/// A corner of the lower convex hull of log P95 against log time: more time beyond it buys less
/// than before it.
struct TradeKnee {
  std::size_t score = 0;
  /// How much P95 falls for each per cent of time, in per cent: up to here, and from here on.
  double gain_before = 0, gain_after = 0;
};

/// The most of a picture that may be missed or false, percent, where settings are compared by P95:
/// a setting that finds only surfaces that are easy to detect would have the least P95.
inline constexpr double kMostWrongPercent = 5;

/// The knees of the points within kMostWrongPercent, by time, without the ends of the hull.
/// `front`: the result of trade_front().
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
