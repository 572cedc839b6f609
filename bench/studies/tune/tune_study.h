// The command `tune`: searches a plan's settings for what a request asks, and confirms what it
// finds on seeds and scenes that the search did not see.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/studies/tune/tune_request.h"
#include "bench/studies/tune/tune_search.h"

namespace wobblebench::bench {

struct TuneOptions {
  TuneRequest request;
  SearchOptions search;
  int fresh_seeds = 3;    ///< after the plan's; 2 at least
  int judging_seeds = 0;  ///< after those: what is chosen is measured on them, and chooses nothing
};

/// A setting that the search found good, on fresh seeds.
struct TuneCandidate {
  std::size_t point = 0;
  TradeScore searched;              ///< on the plan's seeds
  std::optional<TradeScore> fresh;  ///< none: refused there
  /// Each limit holds for the upper_quantity() of the fresh seeds.
  bool holds = false;
};

struct UnseenScore {
  std::string scene;
  std::optional<TradeScore> score;
};

struct TuneResults {
  TradeWork work;  ///< with the points that were tried
  TuneOptions options;
  std::vector<std::uint64_t> fresh_seeds;
  std::size_t known = 0;                  ///< points of the trade that was given
  std::size_t evaluated = 0;              ///< points that were measured beside them
  std::size_t refused = 0;                ///< of those
  std::vector<TuneCandidate> candidates;  ///< in the order in which they were tried
  /// Of `candidates`: the one that holds, which is the last; none: nothing was found.
  const TuneCandidate* chosen() const;
  std::optional<TradeScore> judged;    ///< the chosen one on the judging seeds; none: not asked for
  std::vector<UnseenScore> unseen;     ///< of the chosen one
  std::vector<std::string> at_an_end;  ///< keys whose chosen value is the first or last of the plan
};

inline constexpr std::size_t kMostCandidates = 8;

/// `known`: records of `work`'s points. Throws std::runtime_error; UserError where the reference is
/// refused.
TuneResults tune(TradeWork work,
                 const TuneOptions& options,
                 TradeRecords known,
                 render::GlContext& context,
                 PhantomCache& cache,
                 const PartDone& done);

/// Keys of numbers whose value is the least or the greatest that the plan has, 3 % of a range's
/// ends included.
std::vector<std::string> keys_at_an_end(const TradePlan& plan, const TradePoint& point);

}  // namespace wobblebench::bench
