#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/text.h"
#include "bench/output/report_parts.h"
#include "bench/studies/accuracy/accuracy_report.h"
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

void add(const TradeScore& score, Series& series) {
  series.x.push_back(score.volume_ratio);
  series.y.push_back(score.p95_mm());
}

}  // namespace

std::string trade_csv(const TradeResults& results) {
  const TradePlan& plan = results.work.plan;
  std::ostringstream csv;
  csv << "scene,point,seed";
  for (const TradeAxis& axis : plan.axes) csv << "," << axis.key;
  for (const std::string& name : trade_measure_names()) csv << "," << name;
  csv << ",refused";
  for (const auto& [name, time] : kTradeTimes) csv << "," << name;
  csv << "\n";
  for (const auto& [unit, record] : results.records) {
    csv << plan.scenes[unit.scene].name << "," << unit.point << "," << plan.seeds[unit.seed];
    for (const std::string& value : results.work.points[unit.point].values) {
      csv << "," << csv_field(plain_value(value));
    }
    if (!record.refused.empty()) {
      csv << std::string(trade_measure_names().size(), ',') << "," << csv_field(record.refused)
          << ",,,,\n";
      continue;
    }
    for (const double value : record.measures) csv << "," << csv_number(value);
    csv << ",";
    for (const auto& [name, time] : kTradeTimes) csv << "," << csv_number(record.*time);
    csv << "\n";
  }
  return csv.str();
}

Json trade_score_json(const TradeWork& work, const TradeScore& score) {
  Json json = {{"point", score.point},
               {"settings", settings_json(work, score.point)},
               {"volume_ratio", score.volume_ratio},
               {"view_ratio", score.view_ratio},
               {"volume_ms", score.volume_ms},
               {"view_ms", score.view_ms}};
  for (std::size_t i = 0; i < score.measures.size(); ++i) {
    json[trade_measure_names()[i]] = {{"mean", number(score.measures[i].mean)},
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

std::optional<Figure> trade_figure(const TradeResults::Part& part) {
  if (part.front.empty()) return std::nullopt;
  Chart chart{"Time and error: " + part.name,
              {"picture of a new volume / the reference's", Scale::logarithmic},
              {"depth error, P95 (mm)", Scale::logarithmic}};
  Series all{"points", {}, {}, Stroke::none, Mark::disc, 4};
  Series front{"front: time, P95, missed or false", {}, {}, Stroke::none, Mark::square, 0};
  Series knees{"knees", {}, {}, Stroke::solid, Mark::diamond, 1};
  for (const TradeScore& score : part.scores) add(score, all);
  for (const std::size_t i : part.front) add(part.scores[i], front);
  for (const TradeKnee& knee : part.knees) add(part.scores[knee.score], knees);
  chart.series = {all, front};
  if (!knees.x.empty()) chart.series.push_back(knees);
  std::string name = part.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return Figure{name,
                "Every point on " + part.name + ", and the front of time, P95 and missed or false.",
                {chart}};
}

}  // namespace wobblebench::bench
