#include <nlohmann/json.hpp>

#include "bench/studies/trade/trade_report.h"
#include "bench/studies/tune/tune_report.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

Json score_or_null(const TradeWork& work, const std::optional<TradeScore>& score) {
  return score ? trade_score_json(work, *score) : Json(nullptr);
}

}  // namespace

Json tune_json(const TuneResults& results) {
  const TuneRequest& request = results.options.request;
  Json limits = Json::object(), candidates = Json::array(), unseen = Json::object();
  for (const TuneLimit& limit : request.limits) limits[limit.name] = limit.most;
  for (const TuneCandidate& candidate : results.candidates) {
    candidates.push_back({{"point", candidate.point},
                          {"searched", trade_score_json(results.work, candidate.searched)},
                          {"fresh", score_or_null(results.work, candidate.fresh)},
                          {"holds", candidate.holds}});
  }
  for (const UnseenScore& scene : results.unseen) {
    unseen[scene.scene] = score_or_null(results.work, scene.score);
  }
  const TuneCandidate* chosen = results.chosen();
  return {{"least", request.least},
          {"limits", limits},
          {"known_points", results.known},
          {"measured_points", results.evaluated},
          {"refused_points", results.refused},
          {"fresh_seeds", results.fresh_seeds},
          {"candidates", candidates},
          {"chosen", chosen == nullptr ? Json(nullptr) : Json(chosen->point)},
          {"at_an_end", results.at_an_end},
          {"unseen", unseen}};
}

}  // namespace wobblebench::bench
