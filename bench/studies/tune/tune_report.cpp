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

/// What is to be least, as a mean over the scenes.
std::string goal_of(const TuneRequest& request) {
  return mean_of(request.least);
}

/// The quantities of the request, then those that every table has, as means over the scenes.
std::vector<std::string> columns_of(const TuneRequest& request) {
  std::vector<std::string> columns{goal_of(request)};
  const auto add = [&](const std::string& name) {
    if (std::ranges::find(columns, name) == columns.end()) columns.push_back(name);
  };
  for (const TuneLimit& limit : request.limits) add(limit.name);
  for (const Measure* always : {&times::kVolume, &error::kP95, &error::kMissed, &error::kFalse}) {
    add(mean_of(always->key));
  }
  return columns;
}

bool is_limited(const TuneRequest& request, const std::string& name) {
  return std::ranges::find(request.limits, name, &TuneLimit::name) != request.limits.end();
}

constexpr int kDigits = 3;

/// A quantity's name for keys: "mean_p95_mm".
std::string key_of(std::string name) {
  std::ranges::replace(name, ':', '_');
  return name;
}

Column quantity_column(const std::string& name, bool several) {
  Column column = column_of(quantity(name));
  column.key = key_of(name);
  if (several) column.title += is_mean(name) ? ", mean of the scenes" : ", worst scene";
  column.digits = kDigits;
  column.significant = true;
  return column;
}

Cell cell(double value) {
  return std::isfinite(value) ? Cell(value) : "none";
}

/// Empty: the mean of all.
std::string scene_of(const Reached& reached, const std::vector<NamedOptions>& scenes) {
  return reached.scene ? scenes.at(*reached.scene).name : "";
}

std::string head_text(const TuneResults& results, const std::string& machine) {
  const TradePlan& plan = results.work.plan;
  std::ostringstream text;
  text << "Made by `wobblebench tune`: " << machine << ". " << plan.axes.size() << " settings, "
       << plan.scenes.size() << " scenes, seeds " << plan.seeds.front() << " to "
       << plan.seeds.back() << "; " << results.evaluated << " points measured (" << results.refused
       << " were refused)";
  if (results.known > 0) text << " beside the " << results.known << " of the trade";
  const bool random = results.options.search.method == SearchMethod::random;
  text << ", searched " << (random ? "at random" : "by NSGA-II") << " with seed "
       << results.options.search.seed << ". Confirmed on the fresh seeds "
       << results.fresh_seeds.front() << " to " << results.fresh_seeds.back()
       << ". All sticks are simulated.";
  return text.str();
}

/// Two rows a candidate: on the seeds of the search, and on fresh ones, where each limit has what a
/// further seed stays below beside it.
class CandidateTable {
 public:
  explicit CandidateTable(const TuneResults& results)
      : results_(results),
        scenes_(results.work.plan.scenes),
        quantities_(columns_of(results.options.request)) {
    const bool several = scenes_.size() > 1;
    for (const std::string& name : quantities_) {
      table_.columns.push_back(quantity_column(name, several));
      if (!is_limited(results.options.request, name)) continue;
      table_.columns.push_back({.key = "bound_" + key_of(name),
                                .title = "bound",
                                .digits = kDigits,
                                .significant = true});
      if (several && !is_mean(name)) table_.columns.push_back({"scene_" + key_of(name), "on"});
    }
  }

  Table made() {
    for (const TuneCandidate& candidate : results_.candidates) {
      add(candidate, Cell(), "searched seeds", candidate.searched, false);
      add(candidate, candidate.holds ? "yes" : "no", "fresh seeds", candidate.fresh, true);
    }
    return std::move(table_);
  }

 private:
  void add(const TuneCandidate& candidate,
           Cell holds,
           const char* seeds,
           const std::optional<TradeScore>& score,
           bool bound) {
    std::vector<Cell> row = {candidate.point, std::move(holds), seeds};
    for (const std::string& name : quantities_) {
      row.push_back(score ? cell(quantity_of(*score, name).value) : "refused");
      if (!is_limited(results_.options.request, name)) continue;
      const Reached upper = score ? upper_quantity(*score, name) : Reached{};
      row.push_back(score && bound ? cell(upper.value) : Cell());
      if (scenes_.size() == 1 || is_mean(name)) continue;
      row.push_back(score ? Cell(scene_of(upper, scenes_)) : Cell());
    }
    table_.add(std::move(row), point_id(candidate.point));
  }

  const TuneResults& results_;
  const std::vector<NamedOptions>& scenes_;
  const std::vector<std::string> quantities_;
  Table table_{.name = "candidates", .columns = {{"point"}, {"holds"}, {"seeds", "measured on"}}};
};

/// The least quantity against one limit: each candidate on the seeds of the search and on fresh
/// ones, with the bound of a further seed, and the limit as the edge of what is not allowed.
Chart candidate_chart(const TuneResults& results, const TuneLimit& limit) {
  const std::string goal = goal_of(results.options.request);
  Chart chart{.title = limit.name + " at most " + significant(limit.most, kDigits),
              .x = {.label = results.options.request.least},
              .y = {.label = limit.name}};
  Series searched{.name = "searched seeds", .stroke = Stroke::none, .mark = Mark::ring};
  Series fresh{.name = "fresh seeds, to the bound", .stroke = Stroke::none, .mark = Mark::disc};
  Series edge{.name = "limit", .stroke = Stroke::dashed, .colour = 6};
  const auto add = [&](const TuneCandidate& candidate, const TradeScore& score, Series& series) {
    series.add(quantity_of(score, goal).value, quantity_of(score, limit.name).value);
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
    fresh.high.push_back(upper_quantity(*candidate.fresh, limit.name).value);
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
      .add(
          Text{"In the order in which they were tried. A limit holds if on no scene a further seed "
               "exceeds it with a probability above 5 % (the bound beside a quantity); times are "
               "compared as measured."});
  if (!figure.panels.empty()) document.add(std::move(figure));
  document.add(CandidateTable(results).made());
  for (const TuneCandidate& candidate : results.candidates) {
    document.add(Detail{.id = point_id(candidate.point),
                        .title = "Point " + std::to_string(candidate.point),
                        .command = results.work.run_command(0, candidate.point),
                        .text = "The command makes its picture on scene " +
                                results.work.plan.scenes.front().name + ".\n\n" +
                                point_text(results.work, candidate.point)});
  }
}

/// " on face", " as the mean of 4 scenes".
std::string on_scene(const Reached& reached, const std::vector<NamedOptions>& scenes) {
  if (reached.scene) return " on " + scene_of(reached, scenes);
  return " as the mean of " + std::to_string(scenes.size()) + " scenes";
}

/// "2.98 on face, of at most 2 (49 % above)".
std::string beyond_limit(const LimitValue& at, const std::vector<NamedOptions>& scenes) {
  const double value = at.reached.value;
  if (!std::isfinite(value)) return "not formed" + on_scene(at.reached, scenes);
  const double percent = 100 * (value / at.limit.most - 1);
  const std::string by = percent > 0 ? significant(percent, 2) + " % above" : "held";
  return significant(value, 3) + on_scene(at.reached, scenes) + ", of at most " +
         significant(at.limit.most, 6) + " (" + by + ")";
}

Json nearest_json(const TuneResults& results) {
  if (!results.nearest) return nullptr;
  Json limits = Json::array();
  for (const auto& [limit, reached] : results.nearest->values) {
    limits.push_back({{"name", limit.name},
                      {"most", limit.most},
                      {"value", number(reached.value)},
                      {"scene", scene_of(reached, results.work.plan.scenes)}});
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
  std::string text = "**" + point_text(results.work, point) + "** (point " + std::to_string(point) +
                     "). As a scene file: `" + tuned_file(results, 0) + "`.\n";
  for (const std::string& key : results.at_an_end) {
    text += "\n- `" + key +
            "` is at an end of what the plan allows; beyond it may lie something better.";
  }
  return text;
}

constexpr const char* kNotJudged =
    "The plan has no `[unseen.NAME]`: the setting was not judged on any scene that the search did "
    "not see.";

/// What the chosen point reaches on each scene: of each limit the mean of the fresh seeds, what a
/// further one stays below, and whether that holds; then what is to be least.
class SceneTable {
 public:
  explicit SceneTable(const TuneResults& results) : request_(results.options.request) {
    for (const TuneLimit& limit : request_.limits) add_columns(limit);
    table_.columns.push_back(column(request_.least, request_.least, ""));
    add_rows(*results.chosen()->fresh, results.work.plan.scenes, "yes");
    const auto& unseen = results.work.plan.unseen;
    if (results.unseen.score) add_rows(*results.unseen.score, unseen, "no");
    for (const std::string& refused : results.unseen.refused) {
      std::vector<Cell> row(table_.columns.size());
      row[0] = refused;
      row[1] = "no";
      row[2] = "refused";
      table_.add(std::move(row));
    }
  }

  const Table& table() const { return table_; }

 private:
  static std::string of_scene(const std::string& name) {
    return is_mean(name) ? name.substr(kMeanOf.size()) : name;
  }
  static Column column(const std::string& name, const std::string& key, const std::string& title) {
    Column column = quantity_column(of_scene(name), false);
    column.key = key;
    column.title += title;
    return column;
  }
  void add_columns(const TuneLimit& limit) {
    const std::string key = key_of(limit.name);
    if (!is_mean(limit.name)) table_.columns.push_back({"held_" + key, "holds"});
    table_.columns.push_back(column(limit.name, key, ""));
    table_.columns.push_back(
        column(limit.name,
               "bound_" + key,
               ", a further seed (at most " + significant(limit.most, 6) + ")"));
  }
  void add_rows(const TradeScore& score,
                const std::vector<NamedOptions>& scenes,
                const char* searched) {
    for (const TradeScore::OnScene& one : score.scenes) {
      std::vector<Cell> row = {scenes.at(one.scene).name, searched};
      for (const TuneLimit& limit : request_.limits) {
        const double bound = figure_of(one, of_scene(limit.name), true);
        if (!is_mean(limit.name)) row.emplace_back(bound <= limit.most ? "yes" : "no");
        row.push_back(cell(figure_of(one, of_scene(limit.name), false)));
        row.push_back(cell(bound));
      }
      row.push_back(cell(figure_of(one, request_.least, false)));
      table_.add(std::move(row));
    }
  }

  const TuneRequest& request_;
  Table table_{.name = "scenes", .columns = {{"scene"}, {"searched"}}};
};

/// What the chosen setting costs and reaches, or the one that is nearest to the limits.
KeyFigures key_figures_of(const TuneResults& results) {
  const TradePlan& plan = results.work.plan;
  KeyFigures figures;
  const auto add = [&](const std::vector<LimitValue>& values,
                       const std::vector<NamedOptions>& scenes,
                       const std::string& reached) {
    for (const LimitValue& at : values) {
      const Measure& measure = quantity(at.limit.name);
      figures.add(measure.title,
                  at.reached.value,
                  measure.key,
                  "At most " + significant(at.limit.most, 6) + "; " + reached +
                      on_scene(at.reached, scenes),
                  !at.holds());
    }
  };
  if (results.nearest) add(results.nearest->values, plan.scenes, "the nearest setting");
  if (const TuneCandidate* const chosen = results.chosen()) {
    const std::string& least = results.options.request.least;
    figures.add(quantity(least).title,
                quantity_of(*chosen->fresh, goal_of(results.options.request)).value,
                least,
                "The least that was found, mean of the scenes; a new volume takes " +
                    fixed(chosen->fresh->volume_ratio, 2) + " of the reference's time");
  }
  add(results.reached(), plan.scenes, "a further seed stays below it");
  add(results.reached_unseen(), plan.unseen, "unseen by the search; a further seed stays below it");
  return figures;
}

void add_chosen(const TuneResults& results, Document& document) {
  const TuneCandidate* chosen = results.chosen();
  if (chosen == nullptr) {
    document.add(Text{nothing_chosen_text(results)}).add(key_figures_of(results));
    return;
  }
  document.add(Text{chosen_text(results, chosen->point)})
      .add(key_figures_of(results))
      .add(SceneTable(results).table())
      .add(Text{"On the fresh seeds. The worst scene must keep a limit, but of a mean (`mean:`) "
                "all together."});
  if (results.work.plan.unseen.empty()) document.add(Text{kNotJudged});
}

Json reached_json(const std::vector<LimitValue>& values, const std::vector<NamedOptions>& scenes) {
  Json json = Json::array();
  for (const LimitValue& at : values) {
    json.push_back(
        {{"name", at.limit.name},
         {"most", at.limit.most},
         {"bound", number(at.reached.value)},
         {"scene", at.reached.scene ? Json(scene_of(at.reached, scenes)) : Json(nullptr)},
         {"held", at.holds()}});
  }
  return json;
}

/// Of the chosen point, scene by scene.
Json scenes_json(const TuneResults& results) {
  return results.chosen() == nullptr ? Json(nullptr) : to_json(SceneTable(results).table());
}

Check check_of(const LimitValue& at, const std::vector<NamedOptions>& scenes, bool unseen) {
  const std::string on = unseen ? ", which the search did not see" : "";
  const std::string text = beyond_limit(at, scenes);
  return {.group = "limits",
          .name = text_of(at.limit) + (unseen ? " on unseen scenes" : ""),
          .failure = at.holds() ? "" : text + on,
          .output = at.holds() ? text + on : "",
          .asked = "--limit " + text_of(at.limit),
          .limit = at.limit.most,
          .value = at.reached.value};
}

}  // namespace

Json limits_json(const TuneRequest& request) {
  Json limits = Json::object();
  for (const TuneLimit& limit : request.limits) limits[limit.name] = limit.most;
  return limits;
}

Json tune_json(const TuneResults& results) {
  const TuneRequest& request = results.options.request;
  Json candidates = Json::array();
  for (const TuneCandidate& candidate : results.candidates) {
    candidates.push_back({{"point", candidate.point},
                          {"searched", trade_score_json(results.work, candidate.searched)},
                          {"fresh", score_or_null(results.work, candidate.fresh)},
                          {"holds", candidate.holds}});
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
          {"scenes", scenes_json(results)},
          {"reached", reached_json(results.reached(), results.work.plan.scenes)},
          {"reached_unseen", reached_json(results.reached_unseen(), results.work.plan.unseen)}};
}

Document tune_document(const TuneResults& results, const std::string& machine) {
  Document document{.title = request_text(results.options.request), .name = "tune"};
  add_chosen(results, document);
  if (!results.candidates.empty()) add_candidates(results, document);
  document.add(Heading{"How it was searched"}).add(Text{head_text(results, machine)});
  return document;
}

std::string nearest_text(const TuneResults& results) {
  if (!results.nearest) return "";
  std::string text = "point " + std::to_string(results.nearest->point) + " (" +
                     point_text(results.work, results.nearest->point) + ")";
  for (const LimitValue& at : results.nearest->values) {
    text += (&at == &results.nearest->values.front() ? ": " : ", ") + at.limit.name + " " +
            beyond_limit(at, results.work.plan.scenes);
  }
  return text + (results.nearest->on_fresh_seeds ? ", bounds of a further seed" : "");
}

std::vector<Check> tune_checks(const TuneResults& results) {
  const TradePlan& plan = results.work.plan;
  std::vector<Check> checks;
  const std::vector<LimitValue> on_scenes =
      results.nearest ? results.nearest->values : results.reached();
  for (const LimitValue& at : on_scenes) checks.push_back(check_of(at, plan.scenes, false));
  for (const LimitValue& at : results.reached_unseen()) {
    checks.push_back(check_of(at, plan.unseen, true));
  }
  for (const std::string& refused : results.unseen.refused) {
    checks.push_back({.group = "limits",
                      .name = "unseen scene " + refused,
                      .failure = "the scene refuses the setting, and the search did not see it",
                      .asked = "[unseen." + refused + "]"});
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
       << results.fresh_seeds.size() << " fresh seeds of simulated sticks:";
  for (const TuneLimit& limit : results.options.request.limits) {
    const Reached reached = quantity_of(*chosen.fresh, limit.name);
    toml << " " << limit.name << " " << significant(reached.value, 3)
         << on_scene(reached, work.plan.scenes) << ",";
  }
  const std::string goal = goal_of(results.options.request);
  toml << " " << goal << " " << significant(quantity_of(*chosen.fresh, goal).value, 3) << ".\n\n"
       << scene_text(work.plan.scenes[scene].file,
                     work.settings(scene, settings_of(work.plan, work.points[chosen.point])));
  return toml.str();
}

}  // namespace wobblebench::bench
