// How well `tune` keeps what it promises: many requests, each searched, confirmed, and judged on
// seeds that neither saw.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "bench/studies/tune/tune_study.h"

namespace wobblebench::bench {

/// How a request is answered.
struct RequestMethod {
  const char* name;
  SearchMethod search;
  bool searches;  ///< false: the best point of the trade is taken
};
inline constexpr RequestMethod kRequestMethods[] = {{"nsga2", SearchMethod::nsga2, true},
                                                    {"random", SearchMethod::random, true},
                                                    {"trade", SearchMethod::nsga2, false}};

struct RequestAnswer {
  std::size_t evaluated = 0;   ///< points that were measured besides the trade's
  std::size_t candidates = 0;  ///< points that were tried on fresh seeds
  /// The chosen point on the seeds that confirmed it: its times are what `tune` predicts. Those of
  /// the search are the least of many noisy ones, and so too small on average. None: nothing held.
  std::optional<TradeScore> confirmed;
  std::optional<TradeScore> judged;  ///< the chosen point on the judging seeds
  bool held = false;                 ///< each limit, for the means of `judged`
};

struct RequestOutcome {
  std::size_t scene = 0;  ///< number of the scene that is asked for
  TuneRequest request;
  std::vector<RequestAnswer> answers;  ///< one for each of kRequestMethods
};

struct RequestStudy {
  TradeWork work;
  TuneOptions options;  ///< but for the request; the seed is also that of the requests
  std::vector<RequestOutcome> outcomes;
};

/// Asks for the least volume_ratio with limits on P95 and on what is missed or false. Each request
/// is for one scene of the plan, in turn, with limits 0 to 30 % above the errors of a random point
/// of that scene's front (of those within kMostWrongPercent, if there are any): it can be met, but
/// not by much. All methods have the trade's points, `known`. Throws std::runtime_error, and
/// UserError for a trade that lacks a scene.
RequestStudy study_requests(const TradeWork& work,
                            int requests,
                            const TuneOptions& options,
                            const TradeRecords& known,
                            TuneJournal& journal,
                            render::GlContext& context,
                            PhantomCache& cache,
                            const PartDone& done = {});

}  // namespace wobblebench::bench
