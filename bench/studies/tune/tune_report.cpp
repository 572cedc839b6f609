#include "bench/studies/tune/tune_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/number_text.h"
#include "bench/output/report_parts.h"
#include "bench/results/error.h"
#include "bench/scene/scene_text.h"
#include "bench/studies/trade/trade_report.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

Json score_or_null(const TradeWork& work, const std::optional<TradeScore>& score) {
  return score ? trade_score_json(work, *score) : Json(nullptr);
}

/// The quantities of the request, then those that every table has.
std::vector<std::string> columns_of(const TuneRequest& request) {
  std::vector<std::string> columns{request.least};
  const auto add = [&](const std::string& name) {
    if (std::find(columns.begin(), columns.end(), name) == columns.end()) columns.push_back(name);
  };
  for (const TuneLimit& limit : request.limits) add(limit.name);
  add(times::kVolume.key);
  for (const Measure* always : {&error::kP95, &error::kMissed, &error::kFalse}) add(always->key);
  return columns;
}

constexpr int kDigits = 3;

std::vector<Column> columns_for(const std::vector<std::string>& quantities) {
  std::vector<Column> columns;
  for (const std::string& name : quantities) {
    columns.push_back(column_of(quantity(name)));
    columns.back().digits = kDigits;
    columns.back().significant = true;
  }
  return columns;
}

Cell cell(const std::optional<TradeScore>& score, const std::string& name) {
  if (!score) return "refused";
  const double value = quantity_of(*score, name);
  return std::isfinite(value) ? Cell(value) : "none";
}

std::string head_text(const TuneResults& results, const std::string& machine) {
  const TradePlan& plan = results.work.plan;
  std::ostringstream text;
  text << "Made by `wobblebench tune`: " << machine << ". " << plan.axes.size() << " settings, "
       << plan.scenes.size() << " scenes, seeds " << plan.seeds.front() << " to "
       << plan.seeds.back() << "; " << results.evaluated << " points measured (" << results.refused
       << " were refused)";
  if (results.known > 0) text << " beside the " << results.known << " of the trade";
  text << ", search seed " << results.options.search.seed << ". Confirmed on the fresh seeds "
       << results.fresh_seeds.front() << " to " << results.fresh_seeds.back()
       << ". All sticks are simulated. Errors are means over the scenes.";
  return text.str();
}

/// Two rows a candidate: on the seeds of the search, and on fresh ones, where a quantity has a
/// bound of a further seed beside it.
Table candidate_table(const TuneResults& results) {
  const auto quantities = columns_of(results.options.request);
  Table table{.name = "candidates", .columns = {{"point"}, {"seeds", "measured on"}}};
  for (const Column& column : columns_for(quantities)) {
    table.columns.push_back(column);
    table.columns.push_back(
        {.key = "bound_" + column.key, .title = "bound", .digits = kDigits, .significant = true});
  }
  table.columns.push_back({"holds"});
  for (const TuneCandidate& candidate : results.candidates) {
    std::vector<Cell> searched = {candidate.point, "searched seeds"};
    std::vector<Cell> fresh = {candidate.point, "fresh seeds"};
    for (const std::string& name : quantities) {
      searched.push_back(cell(candidate.searched, name));
      searched.emplace_back();
      fresh.push_back(cell(candidate.fresh, name));
      fresh.push_back(candidate.fresh ? Cell(upper_quantity(*candidate.fresh, name)) : Cell());
    }
    searched.emplace_back();
    fresh.emplace_back(candidate.holds ? "yes" : "no");
    table.add(std::move(searched), point_id(candidate.point));
    table.add(std::move(fresh), point_id(candidate.point));
  }
  return table;
}

/// The least quantity against one limit: each candidate on the seeds of the search and on fresh
/// ones, with the bound of a further seed, and the limit as the edge of what is not allowed.
Chart candidate_chart(const TuneResults& results, const TuneLimit& limit) {
  const std::string& least = results.options.request.least;
  Chart chart{.title = limit.name + " at most " + significant(limit.most, kDigits),
              .x = {.label = least},
              .y = {.label = limit.name}};
  Series searched{.name = "searched seeds", .stroke = Stroke::none, .mark = Mark::ring};
  Series fresh{.name = "fresh seeds, to the bound", .stroke = Stroke::none, .mark = Mark::disc};
  Series edge{.name = "limit", .stroke = Stroke::dashed, .colour = 6};
  const auto add = [&](const TuneCandidate& candidate, const TradeScore& score, Series& series) {
    series.add(quantity_of(score, least), quantity_of(score, limit.name));
    series.ids.push_back(point_id(candidate.point));
    series.notes.push_back("point " + std::to_string(candidate.point) + ": " +
                           point_text(results.work, candidate.point));
    edge.add(series.x.back(), limit.most);
  };
  for (const TuneCandidate& candidate : results.candidates) {
    add(candidate, candidate.searched, searched);
    if (!candidate.fresh) continue;
    add(candidate, *candidate.fresh, fresh);
    fresh.low.push_back(fresh.y.back());
    fresh.high.push_back(upper_quantity(*candidate.fresh, limit.name));
  }
  chart.series = {std::move(searched), std::move(fresh), std::move(edge)};
  return chart;
}

void add_candidates(const TuneResults& results, Document& document) {
  Figure figure{.name = "candidates",
                .caption =
                    "Candidates by what is to be least and by each limit; a click shows a "
                    "candidate's setting and command."};
  for (const TuneLimit& limit : results.options.request.limits) {
    figure.panels.emplace_back(candidate_chart(results, limit));
  }
  document.add(Heading{"Candidates"})
      .add(Text{
          "In the order in which they were tried. A limit holds if a further seed exceeds it "
          "with a probability of 5 % or less (the bound beside a quantity); times are compared "
          "as measured."});
  if (!figure.panels.empty()) document.add(std::move(figure));
  document.add(candidate_table(results));
  for (const TuneCandidate& candidate : results.candidates) {
    document.add(Detail{.id = point_id(candidate.point),
                        .title = "Point " + std::to_string(candidate.point),
                        .command = results.work.run_command(0, candidate.point),
                        .text = "The command makes its picture on scene " +
                                results.work.plan.scenes.front().name + ".\n\n" +
                                point_text(results.work, candidate.point)});
  }
}

std::string beyond_limit(const TuneNearest::Value& at) {
  if (!std::isfinite(at.value)) return "not formed";
  const double percent = 100 * (at.value / at.limit.most - 1);
  const std::string by = percent > 0 ? significant(percent, 2) + " % above" : "held";
  return significant(at.value, 3) + " of at most " + significant(at.limit.most, 6) + " (" + by +
         ")";
}

Json nearest_json(const TuneResults& results) {
  if (!results.nearest) return nullptr;
  Json limits = Json::array();
  for (const auto& [limit, value] : results.nearest->values) {
    limits.push_back({{"name", limit.name}, {"most", limit.most}, {"value", number(value)}});
  }
  return {{"point", results.nearest->point},
          {"settings", point_text(results.work, results.nearest->point)},
          {"seeds", results.nearest->on_fresh_seeds ? "fresh" : "searched"},
          {"limits", limits}};
}

std::string nothing_chosen_text(const TuneResults& results) {
  const std::string nearest = nearest_text(results);
  return (results.candidates.empty() ? "No setting met the limits on the searched seeds.\n"
                                     : "No candidate held on fresh seeds.\n") +
         (nearest.empty() ? "" : "\nNearest: " + nearest + ".\n");
}

std::string chosen_text(const TuneResults& results, std::size_t point) {
  std::string text = "Point " + std::to_string(point) + ": " + point_text(results.work, point) +
                     ". As a scene file: `" + tuned_file(results, 0) + "`.\n";
  for (const std::string& key : results.at_an_end) {
    text += "\n- `" + key +
            "` is at an end of what the plan allows; beyond it may lie something better.";
  }
  return text;
}

Table unseen_table(const TuneResults& results) {
  const auto quantities = columns_of(results.options.request);
  Table table{.name = "unseen", .columns = {{"scene"}}};
  for (const Column& column : columns_for(quantities)) table.columns.push_back(column);
  for (const UnseenScore& unseen : results.unseen) {
    std::vector<Cell> row = {unseen.scene};
    for (const std::string& name : quantities) row.push_back(cell(unseen.score, name));
    table.add(std::move(row));
  }
  return table;
}

void add_chosen(const TuneResults& results, Document& document) {
  const TuneCandidate* chosen = results.chosen();
  document.add(Heading{"Chosen"});
  if (chosen == nullptr) {
    document.add(Text{nothing_chosen_text(results)});
    return;
  }
  document.add(Text{chosen_text(results, chosen->point)});
  if (results.unseen.empty()) return;
  document.add(Heading{"On scenes that the search did not see"}).add(unseen_table(results));
}

}  // namespace

Json limits_json(const TuneRequest& request) {
  Json limits = Json::object();
  for (const TuneLimit& limit : request.limits) limits[limit.name] = limit.most;
  return limits;
}

Json tune_json(const TuneResults& results) {
  const TuneRequest& request = results.options.request;
  Json candidates = Json::array(), unseen = Json::object();
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
          {"limits", limits_json(request)},
          {"known_points", results.known},
          {"measured_points", results.evaluated},
          {"refused_points", results.refused},
          {"fresh_seeds", results.fresh_seeds},
          {"candidates", candidates},
          {"chosen", chosen == nullptr ? Json(nullptr) : Json(chosen->point)},
          {"nearest", nearest_json(results)},
          {"at_an_end", results.at_an_end},
          {"unseen", unseen}};
}

Document tune_document(const TuneResults& results, const std::string& machine) {
  Document document{.title = request_text(results.options.request), .name = "tune"};
  document.add(Text{head_text(results, machine)});
  if (!results.candidates.empty()) add_candidates(results, document);
  add_chosen(results, document);
  return document;
}

std::string nearest_text(const TuneResults& results) {
  if (!results.nearest) return "";
  std::string text = "point " + std::to_string(results.nearest->point) + " (" +
                     point_text(results.work, results.nearest->point) + ")";
  for (const TuneNearest::Value& at : results.nearest->values) {
    text += (&at == &results.nearest->values.front() ? ": " : ", ") + at.limit.name + " " +
            beyond_limit(at);
  }
  return text + (results.nearest->on_fresh_seeds ? ", bounds of a further seed" : "");
}

std::vector<Check> tune_checks(const TuneResults& results) {
  const TuneCandidate* const chosen = results.chosen();
  std::vector<TuneNearest::Value> values;
  if (results.nearest) values = results.nearest->values;
  if (chosen != nullptr) {
    for (const TuneLimit& limit : results.options.request.limits) {
      values.push_back({limit, upper_quantity(*chosen->fresh, limit.name)});
    }
  }
  std::vector<Check> checks;
  for (const TuneNearest::Value& at : values) {
    const bool held = std::isfinite(at.value) && at.value <= at.limit.most;
    checks.push_back({.group = "limits",
                      .name = text_of(at.limit),
                      .failure = held ? "" : beyond_limit(at),
                      .asked = "--limit " + text_of(at.limit),
                      .limit = at.limit.most,
                      .value = at.value});
  }
  return checks;
}

std::string request_text(const TuneRequest& request) {
  std::string text = "least " + request.least;
  for (const TuneLimit& limit : request.limits) {
    text += &limit == &request.limits.front() ? " with " : " and ";
    text += limit.name + " <= " + significant(limit.most, 6);
  }
  return text;
}

std::string tuned_file(const TuneResults& results, std::size_t scene) {
  const auto& scenes = results.work.plan.scenes;
  return scenes.size() == 1 ? "tuned.toml" : "tuned_" + scenes.at(scene).name + ".toml";
}

std::string tuned_scene(const TuneResults& results, std::size_t scene) {
  const TuneCandidate& chosen = *results.chosen();
  const TradeWork& work = results.work;
  std::ostringstream toml;
  toml << "# `wobblebench tune`, " << request_text(results.options.request) << "; on "
       << results.fresh_seeds.size()
       << " fresh seeds of simulated sticks, mean of the plan's scenes:";
  for (const TuneLimit& limit : results.options.request.limits) {
    toml << " " << limit.name << " " << significant(quantity_of(*chosen.fresh, limit.name), 3)
         << ",";
  }
  const std::string& least = results.options.request.least;
  toml << " " << least << " " << significant(quantity_of(*chosen.fresh, least), 3) << ".\n\n"
       << scene_text(work.plan.scenes[scene].file,
                     work.settings(scene, settings_of(work.plan, work.points[chosen.point])));
  return toml.str();
}

}  // namespace wobblebench::bench
