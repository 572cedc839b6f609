#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/number_text.h"
#include "base/statistics.h"
#include "bench/output/report_parts.h"
#include "bench/studies/tune/tune_report.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kPredicted = 0.2;
constexpr const char* kMethodNames[] = {"nsga2", "random", "trade"};

/// Over the requests that one method answered.
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

/// Judged time of each method over that of another, for the requests that both answered.
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
    markdown << "| " << kMethodNames[method] << " | " << of(summary.answered, study.outcomes.size())
             << " | " << of(summary.held, summary.answered) << " | "
             << significant(quantile(summary.time, 0.5), 3) << " | "
             << against(study, method, std::size(kRequestMethods) - 1) << " | "
             << of(MethodSummary::within(summary.of_ratio), summary.answered) << " | "
             << of(MethodSummary::within(summary.of_time), summary.answered) << " |\n";
  }
}

void write_requests(const RequestStudy& study, std::ostream& markdown) {
  markdown << "\n## Each request\n\nJudged time of a volume, as a ratio to the reference; in "
              "brackets P95 in mm and missed or false in percent on the judging seeds.\n\n| scene "
              "| request |";
  for (const char* name : kMethodNames) markdown << " " << name << " |";
  markdown << "\n| --- | --- | ---: | ---: | ---: |\n";
  for (const RequestOutcome& outcome : study.outcomes) {
    markdown << "| " << study.work.plan.scenes[outcome.scene].name << " | "
             << request_text(outcome.request);
    for (const RequestAnswer& answer : outcome.answers) {
      markdown << " | ";
      if (!answer.judged) {
        markdown << "nothing held";
        continue;
      }
      markdown << significant(answer.judged->volume_ratio, 3) << " ("
               << significant(answer.judged->p95_mm(), 3) << ", "
               << significant(answer.judged->wrong_percent(), 3) << ")"
               << (answer.held ? "" : " **exceeded**");
    }
    markdown << " |\n";
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

std::string requests_markdown(const RequestStudy& study, const std::string& machine) {
  const RequestStudyOptions& options = study.options;
  std::ostringstream markdown;
  markdown
      << "# " << study.outcomes.size()
      << " requests\n\nMade by `wobblebench tune --requests`: " << machine
      << ". Each asks for the least time of a volume of one scene with limits on P95 and on what "
         "is "
      << "missed or false, drawn 0 to 30 % above those of a random point of that scene's front in "
         "the trade (request seed "
      << options.seed << "). Answered by NSGA-II and by a random search with "
      << options.evaluations << " evaluations each, and by the trade's points alone; confirmed on "
      << options.fresh_seeds << " fresh seeds, then judged on " << options.judging_seeds
      << " further ones that chose nothing. A request is held if the means over the judging seeds "
         "are within its limits; a time is predicted by the confirming seeds. All sticks are "
         "simulated.\n";
  write_summary(study, markdown);
  write_requests(study, markdown);
  return markdown.str();
}

Json requests_json(const RequestStudy& study) {
  Json requests = Json::array();
  for (const RequestOutcome& outcome : study.outcomes) {
    Json limits = Json::object(), answers = Json::object();
    for (const TuneLimit& limit : outcome.request.limits) limits[limit.name] = limit.most;
    for (std::size_t i = 0; i < std::size(kMethodNames); ++i) {
      answers[kMethodNames[i]] = answer_json(outcome.answers.at(i));
    }
    requests.push_back({{"scene", study.work.plan.scenes[outcome.scene].name},
                        {"least", outcome.request.least},
                        {"limits", limits},
                        {"answers", answers}});
  }
  return requests;
}

}  // namespace wobblebench::bench
