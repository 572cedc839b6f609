#include "bench/studies/tune/request_study.h"

#include <algorithm>
#include <iterator>
#include <random>
#include <string>
#include <utility>

#include "base/hash.h"
#include "base/user_error.h"
#include "bench/results/error.h"

namespace wobblebench::bench {

namespace {

constexpr double kMostAbove = 0.3;
constexpr const char* kLimited[] = {error::kP95.key, error::kMissedOrFalse.key};

/// One scene of a plan, with its measurements and its front.
struct SceneTrade {
  TradeWork work;
  TradeRecords known;
  std::vector<TradeScore> front;
};

SceneTrade trade_of_scene(const TradeWork& work, const TradeRecords& known, std::size_t scene) {
  SceneTrade trade{work, {}, {}};
  trade.work.plan.scenes = {work.plan.scenes[scene]};
  trade.work.plan.unseen.clear();
  for (const auto& [unit, record] : known) {
    if (unit.scene != scene) continue;
    TradeRecord own = record;
    own.unit.scene = 0;
    trade.known.emplace(own.unit, own);
  }
  const auto scores = trade_scores(trade.work, trade.known, {0});
  for (const std::size_t i : trade_front(scores)) trade.front.push_back(scores[i]);
  if (trade.front.empty()) {
    throw UserError("--trade: no point is measured on scene " + work.plan.scenes[scene].name +
                    "; finish the trade first");
  }
  return trade;
}

TuneRequest draw_request(const std::vector<TradeScore>& front, std::mt19937_64& random) {
  const TradeScore& about = front[random() % front.size()];
  TuneRequest request{.least = "volume_ratio", .limits = {}};
  for (const char* name : kLimited) {
    const double above = kMostAbove * unit_interval(random());
    request.limits.push_back({name, quantity_of(about, name).value * (1 + above)});
  }
  return request;
}

RequestAnswer answer_of(const TuneResults& results) {
  RequestAnswer answer;
  answer.evaluated = results.evaluated;
  answer.candidates = results.candidates.size();
  if (results.chosen() == nullptr) return answer;
  answer.confirmed = results.chosen()->fresh;
  answer.judged = results.judged;
  answer.held = results.judged && excess_of(results.options.request, *results.judged) == 0;
  return answer;
}

}  // namespace

RequestStudy study_requests(const TradeWork& work,
                            int requests,
                            const TuneOptions& options,
                            const TradeRecords& known,
                            TuneJournal& journal,
                            render::GlContext& context,
                            PhantomCache& cache,
                            const PartDone& done) {
  std::vector<SceneTrade> trades;
  for (const std::size_t scene : all_scenes(work.plan)) {
    trades.push_back(trade_of_scene(work, known, scene));
  }
  RequestStudy study{work, options, {}};
  std::mt19937_64 random(options.search.seed);
  PartCount parts(static_cast<std::size_t>(requests) * std::size(kRequestMethods), done);
  for (int i = 0; i < requests; ++i) {
    const std::size_t scene = static_cast<std::size_t>(i) % trades.size();
    const SceneTrade& trade = trades[scene];
    RequestOutcome outcome{scene, draw_request(trade.front, random), {}};
    TuneOptions chosen = options;
    chosen.request = outcome.request;
    chosen.search.seed = random() >> 33;
    for (const RequestMethod& method : kRequestMethods) {
      chosen.search.method = method.search;
      chosen.search.evaluations = method.searches ? options.search.evaluations : 0;
      const std::string part = "request " + std::to_string(i) + " " + method.name;
      outcome.answers.push_back(
          answer_of(tune(trade.work, chosen, trade.known, {&journal, part}, context, cache, {})));
      parts.finish_one();
    }
    study.outcomes.push_back(std::move(outcome));
  }
  return study;
}

}  // namespace wobblebench::bench
