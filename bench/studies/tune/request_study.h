// How well `tune` keeps what it promises: many requests, each searched, confirmed, and judged on
// seeds that neither saw.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "bench/studies/tune/tune_study.h"

namespace wobblebench::bench {

/// One way to answer a request. `trade`: the best point of the trade alone.
enum class RequestMethod { nsga2, random, trade };
inline constexpr RequestMethod kRequestMethods[] = {
    RequestMethod::nsga2, RequestMethod::random, RequestMethod::trade};

struct RequestAnswer {
  std::size_t evaluated = 0;   ///< points that were measured beside the trade's
  std::size_t candidates = 0;  ///< tried on fresh seeds
  /// Of the chosen setting, on the seeds that confirmed it: its times are what `tune` predicts.
  /// Those of the search are the least of many, and so too small on average. None: nothing held.
  std::optional<TradeScore> confirmed;
  std::optional<TradeScore> judged;  ///< likewise, on the judging seeds
  bool held = false;                 ///< each limit, for the means of `judged`
};

struct RequestOutcome {
  std::size_t scene = 0;  ///< of the plan: whose front it was drawn about, and which answers it
  TuneRequest request;
  std::vector<RequestAnswer> answers;  ///< of kRequestMethods
};

struct RequestStudyOptions {
  int requests = 40;
  int evaluations = 24;  ///< of each search; all methods have the trade's points besides
  int fresh_seeds = 3, judging_seeds = 3;
  std::uint64_t seed = 1;  ///< of requests and searches
};

struct RequestStudy {
  TradeWork work;
  RequestStudyOptions options;
  std::vector<RequestOutcome> outcomes;
};

/// The least volume_ratio with limits on P95 and on what is missed or false. Each request is of one
/// scene of the plan, in turn, and drawn about a random point of that scene's front (of those
/// within kMostWrongPercent, if there are any), 0 to 30 % above its errors: it can be met, but not
/// by much. Throws std::runtime_error, and UserError
/// for a trade that lacks a scene.
RequestStudy study_requests(const TradeWork& work,
                            const RequestStudyOptions& options,
                            const TradeRecords& known,
                            render::GlContext& context,
                            PhantomCache& cache,
                            const PartDone& done = {});

}  // namespace wobblebench::bench
