#include <numeric>
#include <set>
#include <utility>

#include "bench/studies/trade/trade_report.h"

namespace wobblebench::bench {

namespace {

TradeResults::Part part_of(const TradeResults& results,
                           const std::string& name,
                           const std::vector<std::size_t>& scenes) {
  TradeResults::Part part{name, trade_scores(results.work, results.records, scenes), {}, {}};
  part.front = trade_front(part.scores);
  part.knees = trade_knees(part.scores, part.front);
  return part;
}

/// The key without its section.
std::string short_name(const std::string& key) {
  return key.substr(key.rfind('.') + 1);
}

}  // namespace

TradeResults trade_results(TradeWork work, TradeContent content) {
  TradeResults results{
      std::move(work), std::move(content.records), std::move(content.machines), {}, 0, {}};
  const auto& scenes = results.work.plan.scenes;
  if (scenes.size() > 1) {
    std::vector<std::size_t> all(scenes.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    results.parts.push_back(part_of(results, "all scenes", all));
  }
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    results.parts.push_back(part_of(results, scenes[i].name, {i}));
  }
  std::set<std::size_t> refused;
  for (const auto& [unit, record] : results.records) {
    if (record.refused.empty()) continue;
    if (refused.empty()) results.first_refusal = record.refused;
    refused.insert(unit.point);
  }
  results.refused = refused.size();
  return results;
}

std::string point_text(const TradeWork& work, std::size_t point, const std::size_t* from) {
  std::string text;
  for (std::size_t i = 0; i < work.plan.axes.size(); ++i) {
    const std::string& value = work.points[point].values[i];
    if (from != nullptr && work.points[*from].values[i] == value) continue;
    text +=
        (text.empty() ? "" : ", ") + short_name(work.plan.axes[i].key) + " " + plain_value(value);
  }
  return text.empty() ? "the same setting" : text;
}

}  // namespace wobblebench::bench
