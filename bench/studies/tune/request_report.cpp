#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "base/statistics.h"
#include "bench/output/report_parts.h"
#include "bench/results/error.h"
#include "bench/studies/tune/tune_report.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kPredicted = 0.2;  // a time is, if the measured one is less than that off
constexpr int kRequestDigits = 3;

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

/// Ratios of the judged times of two methods, over the requests that both answered.
std::vector<double> ratios_of(const RequestStudy& study, std::size_t method, std::size_t other) {
  std::vector<double> ratios;
  for (const RequestOutcome& outcome : study.outcomes) {
    const auto &a = outcome.answers[method].judged, &b = outcome.answers[other].judged;
    if (a && b) ratios.push_back(a->volume_ratio / b->volume_ratio);
  }
  return ratios;
}

Cell quartiles_cell(const std::vector<double>& values) {
  if (values.empty()) return "none";
  const Quartiles quartiles = quartiles_of(values);
  return Cell::spread(quartiles.median, quartiles.lower, quartiles.upper);
}

Table method_table(const RequestStudy& study) {
  Table table{.name = "methods",
              .columns = {{"method"},
                          {"answered"},
                          {"held", "held on judging seeds"},
                          {.key = "volume_ratio",
                           .title = "time of volume, ratio, median",
                           .digits = kRequestDigits,
                           .significant = true},
                          {.key = "of_trade",
                           .title = "over that of the trade alone, median (quartiles)",
                           .digits = kRequestDigits,
                           .significant = true},
                          {"n", "requests that both answered"},
                          {"ratio_within_20_percent", "time predicted within 20 %: ratio"},
                          {"ms_within_20_percent", "in ms"}}};
  for (std::size_t method = 0; method < std::size(kRequestMethods); ++method) {
    const MethodSummary summary(study, method);
    const auto ratios = ratios_of(study, method, std::size(kRequestMethods) - 1);
    table.add({kRequestMethods[method].name,
               of(summary.answered, study.outcomes.size()),
               of(summary.held, summary.answered),
               quantile(summary.time, 0.5),
               quartiles_cell(ratios),
               ratios.size(),
               of(MethodSummary::within(summary.of_ratio), summary.answered),
               of(MethodSummary::within(summary.of_time), summary.answered)});
  }
  return table;
}

/// P95 of each answer against the limit that was asked for, both on the judging seeds.
Chart request_chart(const RequestStudy& study, std::size_t limit) {
  const std::string name = study.outcomes.front().request.limits.at(limit).name;
  Chart chart{.title = "Judged against asked: " + name,
              .x = {.label = "limit, " + name},
              .y = {.label = "judged, " + name}};
  Series edge{.name = "limit", .mark = Mark::none, .colour = 6};
  for (std::size_t method = 0; method < std::size(kRequestMethods); ++method) {
    constexpr Mark kMarks[] = {Mark::disc, Mark::square, Mark::diamond};
    Series series{.name = kRequestMethods[method].name,
                  .stroke = Stroke::none,
                  .mark = kMarks[method % std::size(kMarks)]};
    for (const RequestOutcome& outcome : study.outcomes) {
      const auto& judged = outcome.answers[method].judged;
      if (!judged) continue;
      const double most = outcome.request.limits.at(limit).most;
      series.add(most, quantity_of(*judged, name).value);
      edge.add(most, most);
    }
    chart.series.push_back(std::move(series));
  }
  std::sort(edge.x.begin(), edge.x.end());
  edge.y = edge.x;
  chart.series.push_back(std::move(edge));
  return chart;
}

Json answer_json(const RequestAnswer& answer) {
  const auto score = [](const std::optional<TradeScore>& value) {
    if (!value) return Json(nullptr);
    return Json{{"volume_ratio", value->volume_ratio},
                {"volume_ms", value->volume_ms},
                {error::kP95.key, number(value->p95_mm())},
                {error::kMissedOrFalse.key, number(value->wrong_percent())}};
  };
  return {{"measured_points", answer.evaluated},
          {"candidates", answer.candidates},
          {"confirmed", score(answer.confirmed)},
          {"judged", score(answer.judged)},
          {"held", answer.held}};
}

/// What the default method promises and keeps.
KeyFigures answer_of(const RequestStudy& study) {
  const MethodSummary summary(study, 0);
  const std::string by = std::string("by ") + kRequestMethods[0].name;
  return {{{"Answered", of(summary.answered, study.outcomes.size()), "requests", by},
           {"Within their limits",
            of(summary.held, summary.answered),
            "answers",
            by + ", judged on seeds that chose nothing",
            summary.held < summary.answered},
           {"Time as promised",
            of(MethodSummary::within(summary.of_ratio), summary.answered),
            "answers",
            "less than 20 % off, as a ratio to the reference's; in milliseconds " +
                of(MethodSummary::within(summary.of_time), summary.answered)}}};
}

}  // namespace

Document requests_document(const RequestStudy& study, const std::string& machine) {
  const TuneOptions& options = study.options;
  std::ostringstream text;
  text << "Made by `wobblebench tune --requests`: " << machine
       << ". Each asks for the least time of a volume of one scene with limits on P95 and on what "
          "is "
          "missed or false, drawn 0 to 30 % above those of a random point of that scene's front in "
          "the trade (request seed "
       << options.search.seed << "). Answered by NSGA-II and by a random search with "
       << options.search.evaluations
       << " evaluations each, and by the trade's points alone; confirmed on " << options.fresh_seeds
       << " fresh seeds, then judged on " << options.judging_seeds
       << " further ones that chose nothing. A request is held if the means over the judging seeds "
          "are within its limits; a time is predicted by the confirming seeds. All sticks are "
          "simulated. Each request and its answers are in `report.json`.";
  Document document{.title = std::to_string(study.outcomes.size()) + " requests",
                    .name = "requests"};
  document.add(answer_of(study))
      .add(Text{text.str()})
      .add(method_table(study))
      .add(Figure{.name = "judged",
                  .caption = "Each answer on the judging seeds against the limit of its request; "
                             "what lies above the line is not held.",
                  .panels = {request_chart(study, 0), request_chart(study, 1)}});
  return document;
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
