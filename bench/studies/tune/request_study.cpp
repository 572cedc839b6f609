#include "bench/studies/tune/request_study.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <stdexcept>

namespace wobblebench::bench {

namespace {

constexpr double kMostAbove = 0.3;
constexpr const char* kLimited[] = {"p95_mm", "missed_or_false_percent"};

std::vector<TradeScore> front_of(const TradeWork& work, const TradeRecords& known) {
  std::vector<std::size_t> scenes(work.plan.scenes.size());
  std::iota(scenes.begin(), scenes.end(), std::size_t{0});
  const auto scores = trade_scores(work, known, scenes);
  std::vector<TradeScore> front;
  for (const std::size_t i : trade_front(scores)) front.push_back(scores[i]);
  return front;
}

double share(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

TuneRequest draw_request(const std::vector<TradeScore>& front, std::mt19937_64& random) {
  const TradeScore& about = front[random() % front.size()];
  TuneRequest request{.least = "volume_ratio", .limits = {}};
  for (const char* name : kLimited) {
    request.limits.push_back({name, quantity_of(about, name) * (1 + kMostAbove * share(random))});
  }
  return request;
}

TuneOptions tune_options(const TuneRequest& request,
                         RequestMethod method,
                         const RequestStudyOptions& options,
                         std::uint64_t seed) {
  TuneOptions tune;
  tune.request = request;
  tune.search.method = method == RequestMethod::random ? SearchMethod::random : SearchMethod::nsga2;
  tune.search.evaluations = method == RequestMethod::trade ? 0 : options.evaluations;
  tune.search.seed = seed;
  tune.fresh_seeds = options.fresh_seeds;
  tune.judging_seeds = options.judging_seeds;
  return tune;
}

RequestAnswer answer_of(const TuneResults& results) {
  RequestAnswer answer;
  answer.evaluated = results.evaluated;
  answer.candidates = results.candidates.size();
  if (results.chosen() == nullptr) return answer;
  answer.searched = results.chosen()->searched;
  answer.judged = results.judged;
  answer.held = results.judged && excess_of(results.options.request, *results.judged) == 0;
  return answer;
}

}  // namespace

RequestStudy study_requests(const TradeWork& work,
                            const RequestStudyOptions& options,
                            const TradeRecords& known,
                            render::GlContext& context,
                            PhantomCache& cache,
                            const PartDone& done) {
  const auto front = front_of(work, known);
  if (front.empty()) throw std::invalid_argument("requests need a trade with a front");
  RequestStudy study{work, options, {}};
  study.work.plan.unseen.clear();
  std::mt19937_64 random(options.seed);
  PartCount parts(static_cast<std::size_t>(options.requests) * std::size(kRequestMethods), done);
  for (int i = 0; i < options.requests; ++i) {
    RequestOutcome outcome{draw_request(front, random), {}};
    const std::uint64_t seed = random() >> 33;
    for (const RequestMethod method : kRequestMethods) {
      const TuneOptions chosen = tune_options(outcome.request, method, options, seed);
      outcome.answers.push_back(answer_of(tune(study.work, chosen, known, context, cache, {})));
      parts.finish_one();
    }
    study.outcomes.push_back(std::move(outcome));
  }
  return study;
}

}  // namespace wobblebench::bench
