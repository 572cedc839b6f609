#include "bench/studies/tune/tune_report.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/number_text.h"
#include "base/statistics.h"
#include "bench/output/report_parts.h"
#include "bench/studies/trade/trade_report.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kPredicted = 0.2;  // a time is, if the measured one is less than that off

Json limits_json(const TuneRequest& request) {
  Json limits = Json::object();
  for (const TuneLimit& limit : request.limits) limits[limit.name] = limit.most;
  return limits;
}

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
  for (const char* name : {"volume_ms", "p95_mm", "missed_percent", "false_percent"}) add(name);
  return columns;
}

std::string cell(const std::optional<TradeScore>& score, const std::string& name) {
  if (!score) return "refused";
  const double value = quantity_of(*score, name);
  return std::isfinite(value) ? significant(value, 3) : "none";
}

void write_head(const TuneResults& results, const std::string& machine, std::ostream& markdown) {
  const TradePlan& plan = results.work.plan;
  markdown << "# " << request_text(results.options.request)
           << "\n\nMade by `wobblebench tune`: " << machine << ". " << plan.axes.size()
           << " settings, " << plan.scenes.size() << " scenes, seeds " << plan.seeds.front()
           << " to " << plan.seeds.back() << "; " << results.evaluated << " points measured ("
           << results.refused << " were refused)";
  if (results.known > 0) markdown << " beside the " << results.known << " of the trade";
  markdown << ", search seed " << results.options.search.seed << ". Confirmed on the fresh seeds "
           << results.fresh_seeds.front() << " to " << results.fresh_seeds.back()
           << ". All sticks are simulated. Errors are means over the scenes.\n";
}

void write_candidates(const TuneResults& results, std::ostream& markdown) {
  const auto columns = columns_of(results.options.request);
  markdown
      << "\n## Candidates\n\nIn the order in which they were tried. A limit holds if a further "
         "seed exceeds it with a probability of 5 % or less (in brackets: that bound); times "
         "are compared as measured.\n\n| point | measured on |";
  for (const std::string& name : columns) markdown << " " << name << " |";
  markdown << " holds |\n| ---: | --- |";
  for (std::size_t i = 0; i < columns.size(); ++i) markdown << " ---: |";
  markdown << " --- |\n";
  for (const TuneCandidate& candidate : results.candidates) {
    markdown << "| " << candidate.point << " | searched seeds |";
    for (const std::string& name : columns)
      markdown << " " << cell(candidate.searched, name) << " |";
    markdown << " |\n| | fresh seeds |";
    for (const std::string& name : columns) {
      markdown << " " << cell(candidate.fresh, name);
      if (candidate.fresh && std::isfinite(upper_quantity(*candidate.fresh, name))) {
        markdown << " (" << significant(upper_quantity(*candidate.fresh, name), 3) << ")";
      }
      markdown << " |";
    }
    markdown << (candidate.holds ? " yes |\n" : " no |\n");
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

void write_chosen(const TuneResults& results, std::ostream& markdown) {
  const TuneCandidate* chosen = results.chosen();
  markdown << "\n## Chosen\n\n";
  if (chosen == nullptr) {
    markdown << (results.candidates.empty() ? "No setting met the limits on the searched seeds.\n"
                                            : "No candidate held on fresh seeds.\n");
    const std::string nearest = nearest_text(results);
    if (!nearest.empty()) markdown << "\nNearest: " << nearest << ".\n";
    return;
  }
  markdown << "Point " << chosen->point << ": " << point_text(results.work, chosen->point)
           << ". As a scene file: `tuned.toml`.\n";
  for (const std::string& key : results.at_an_end) {
    markdown << "\n- `" << key
             << "` is at an end of what the plan allows; beyond it may lie something better.";
  }
  if (!results.at_an_end.empty()) markdown << "\n";
  if (results.unseen.empty()) return;
  const auto columns = columns_of(results.options.request);
  markdown << "\n## On scenes that the search did not see\n\n| scene |";
  for (const std::string& name : columns) markdown << " " << name << " |";
  markdown << "\n| --- |";
  for (std::size_t i = 0; i < columns.size(); ++i) markdown << " ---: |";
  for (const UnseenScore& unseen : results.unseen) {
    markdown << "\n| " << unseen.scene << " |";
    for (const std::string& name : columns) markdown << " " << cell(unseen.score, name) << " |";
  }
  markdown << "\n";
}

/// Statistics of the requests that one method answered.
struct MethodSummary {
  std::size_t answered = 0, held = 0;
  std::vector<double> time;               ///< judged volume_ratio
  std::vector<double> of_ratio, of_time;  ///< judged time over the predicted one

  explicit MethodSummary(const RequestStudy& study, std::size_t method) {
    for (const RequestOutcome& outcome : study.outcomes) {
      const RequestAnswer& answer = outcome.answers[method];
      if (!answer.judged) continue;
      ++answered;
      held += answer.held ? 1 : 0;
      time.push_back(answer.judged->volume_ratio);
      of_ratio.push_back(answer.judged->volume_ratio / answer.confirmed->volume_ratio);
      of_time.push_back(answer.judged->volume_ms / answer.confirmed->volume_ms);
    }
  }
  static std::size_t within(const std::vector<double>& ratios) {
    return static_cast<std::size_t>(std::ranges::count_if(
        ratios, [](double ratio) { return std::abs(ratio - 1) <= kPredicted; }));
  }
};

std::string of(std::size_t count, std::size_t all) {
  return std::to_string(count) + " of " + std::to_string(all);
}

/// Ratio of the judged times of two methods, over the requests that both answered.
std::string against(const RequestStudy& study, std::size_t method, std::size_t other) {
  std::vector<double> ratios;
  for (const RequestOutcome& outcome : study.outcomes) {
    const auto &a = outcome.answers[method].judged, &b = outcome.answers[other].judged;
    if (a && b) ratios.push_back(a->volume_ratio / b->volume_ratio);
  }
  if (ratios.empty()) return "none";
  const Quartiles quartiles = quartiles_of(ratios);
  return significant(quartiles.median, 3) + " (" + significant(quartiles.lower, 3) + " to " +
         significant(quartiles.upper, 3) + "), n = " + std::to_string(ratios.size());
}

void write_summary(const RequestStudy& study, std::ostream& markdown) {
  markdown
      << "\n| method | answered | held on judging seeds | time of volume, ratio, median | over "
         "that of the trade alone, median (quartiles) | time predicted within 20 %: ratio | in "
         "ms |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: |\n";
  for (std::size_t method = 0; method < std::size(kRequestMethods); ++method) {
    const MethodSummary summary(study, method);
    markdown << "| " << kRequestMethods[method].name << " | "
             << of(summary.answered, study.outcomes.size()) << " | "
             << of(summary.held, summary.answered) << " | "
             << significant(quantile(summary.time, 0.5), 3) << " | "
             << against(study, method, std::size(kRequestMethods) - 1) << " | "
             << of(MethodSummary::within(summary.of_ratio), summary.answered) << " | "
             << of(MethodSummary::within(summary.of_time), summary.answered) << " |\n";
  }
}

Json answer_json(const RequestAnswer& answer) {
  const auto score = [](const std::optional<TradeScore>& value) {
    if (!value) return Json(nullptr);
    return Json{{"volume_ratio", value->volume_ratio},
                {"volume_ms", value->volume_ms},
                {"p95_mm", number(value->p95_mm())},
                {"missed_or_false_percent", number(value->wrong_percent())}};
  };
  return {{"measured_points", answer.evaluated},
          {"candidates", answer.candidates},
          {"confirmed", score(answer.confirmed)},
          {"judged", score(answer.judged)},
          {"held", answer.held}};
}

}  // namespace

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

std::string tune_markdown(const TuneResults& results, const std::string& machine) {
  std::ostringstream markdown;
  write_head(results, machine, markdown);
  if (!results.candidates.empty()) write_candidates(results, markdown);
  write_chosen(results, markdown);
  return markdown.str();
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

std::string request_text(const TuneRequest& request) {
  std::string text = "least " + request.least;
  for (const TuneLimit& limit : request.limits) {
    text += &limit == &request.limits.front() ? " with " : " and ";
    text += limit.name + " <= " + significant(limit.most, 6);
  }
  return text;
}

std::string tuned_scene(const TuneResults& results) {
  const TuneCandidate& chosen = *results.chosen();
  const TradePlan& plan = results.work.plan;
  std::map<std::string, std::vector<std::string>> sections;
  for (std::size_t i = 0; i < plan.axes.size(); ++i) {
    const std::string& key = plan.axes[i].key;
    const auto dot = key.rfind('.');
    sections[key.substr(0, dot)].push_back(key.substr(dot + 1) + " = " +
                                           results.work.points[chosen.point].values[i]);
  }
  std::ostringstream toml;
  toml << "# `wobblebench tune`, " << request_text(results.options.request) << "; on "
       << results.fresh_seeds.size() << " fresh seeds of simulated sticks:";
  for (const TuneLimit& limit : results.options.request.limits) {
    toml << " " << limit.name << " " << significant(quantity_of(*chosen.fresh, limit.name), 3)
         << ",";
  }
  const std::string& least = results.options.request.least;
  toml << " " << least << " " << significant(quantity_of(*chosen.fresh, least), 3) << ".\n";
  for (const auto& [section, lines] : sections) {
    toml << "\n[" << section << "]\n";
    for (const std::string& line : lines) toml << line << "\n";
  }
  return toml.str();
}

std::string requests_markdown(const RequestStudy& study, const std::string& machine) {
  const TuneOptions& options = study.options;
  std::ostringstream markdown;
  markdown
      << "# " << study.outcomes.size()
      << " requests\n\nMade by `wobblebench tune --requests`: " << machine
      << ". Each asks for the least time of a volume of one scene with limits on P95 and on what "
         "is "
      << "missed or false, drawn 0 to 30 % above those of a random point of that scene's front in "
         "the trade (request seed "
      << options.search.seed << "). Answered by NSGA-II and by a random search with "
      << options.search.evaluations
      << " evaluations each, and by the trade's points alone; confirmed on " << options.fresh_seeds
      << " fresh seeds, then judged on " << options.judging_seeds
      << " further ones that chose nothing. A request is held if the means over the judging seeds "
         "are within its limits; a time is predicted by the confirming seeds. All sticks are "
         "simulated. Each request and its answers are in `report.json`.\n";
  write_summary(study, markdown);
  return markdown.str();
}

Json requests_json(const RequestStudy& study) {
  Json requests = Json::array();
  for (const RequestOutcome& outcome : study.outcomes) {
    Json answers = Json::object();
    for (std::size_t i = 0; i < std::size(kRequestMethods); ++i) {
      answers[kRequestMethods[i].name] = answer_json(outcome.answers.at(i));
    }
    requests.push_back({{"scene", study.work.plan.scenes[outcome.scene].name},
                        {"least", outcome.request.least},
                        {"limits", limits_json(outcome.request)},
                        {"answers", answers}});
  }
  return requests;
}

}  // namespace wobblebench::bench
