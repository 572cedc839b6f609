#include <nlohmann/json.hpp>
#include <utility>

#include "bench/output/report_parts.h"
#include "bench/studies/trade/trade_report.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

Json settings_json(const TradeWork& work, std::size_t point) {
  Json json = Json::object();
  for (std::size_t i = 0; i < work.plan.axes.size(); ++i) {
    json[work.plan.axes[i].key] = plain_value(work.points[point].values[i]);
  }
  return json;
}

}  // namespace

Table trade_rows(const TradeResults& results) {
  const TradePlan& plan = results.work.plan;
  Table table{.name = "rows", .columns = {{"scene"}, {"point"}, {"seed"}}};
  for (const TradeAxis& axis : plan.axes) table.columns.push_back({axis.key});
  table.columns = columns_of(std::move(table.columns), traded());
  table.columns.push_back({"refused"});
  for (const auto& [measure, time] : kTradeTimes) table.columns.push_back(column_of(*measure));
  for (const auto& [unit, record] : results.records) {
    std::vector<Cell> row = {
        plan.scenes[unit.scene].name, unit.point, std::to_string(plan.seeds[unit.seed])};
    for (const std::string& value : results.work.points[unit.point].values) {
      row.emplace_back(plain_value(value));
    }
    const bool measured = record.refused.empty();
    for (std::size_t i = 0; i < traded().size(); ++i) {
      row.push_back(measured ? Cell(record.measures[i]) : Cell());
    }
    row.emplace_back(record.refused);
    for (const auto& [measure, time] : kTradeTimes) {
      row.push_back(measured ? Cell(record.*time) : Cell());
    }
    table.add(std::move(row));
  }
  return table;
}

Json trade_score_json(const TradeWork& work, const TradeScore& score) {
  Json json = {{"point", score.point}, {"settings", settings_json(work, score.point)}};
  for (const auto& [measure, time] : kTradeTimes) json[measure->key] = score.*time;
  for (std::size_t i = 0; i < score.measures.size(); ++i) {
    json[traded()[i]->key] = {{"mean", number(score.measures[i].mean)},
                              {"half_interval", number(score.measures[i].half)},
                              {"n", score.measures[i].n}};
  }
  return json;
}

Json trade_json(const TradeResults& results) {
  Json parts = Json::object();
  for (const TradeResults::Part& part : results.parts) {
    Json front = Json::array(), knees = Json::array();
    for (const std::size_t i : part.front) {
      front.push_back(trade_score_json(results.work, part.scores[i]));
    }
    for (const TradeKnee& knee : part.knees) {
      knees.push_back({{"point", part.scores[knee.score].point},
                       {"gain_before", knee.gain_before},
                       {"gain_after", knee.gain_after}});
    }
    parts[part.name] = {{"front", front}, {"knees", knees}};
  }
  return {{"points", results.work.points.size()},
          {"measurements", results.records.size()},
          {"refused_points", results.refused},
          {"parts", parts}};
}

}  // namespace wobblebench::bench
