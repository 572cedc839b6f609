#include "bench/studies/trade/trade_report.h"

#include <algorithm>
#include <set>
#include <sstream>
#include <utility>

#include "base/number_text.h"
#include "base/statistics.h"
#include "bench/studies/accuracy/accuracy_report.h"

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

constexpr std::ptrdiff_t kMostInteractions = 10;

const char* name_of(TradeResponse response) {
  switch (response) {
    case TradeResponse::log2_volume_ratio:
      return "time, doublings";
    case TradeResponse::p95_mm:
      return "P95, mm";
    case TradeResponse::missed_or_false_percent:
      break;
  }
  return "missed or false, %";
}

void write_head(const TradeResults& results, std::ostream& markdown) {
  const TradePlan& plan = results.work.plan;
  markdown << "# Trade of time against error\n\n"
           << "Made by `wobblebench trade`. " << results.work.points.size() << " points on "
           << plan.scenes.size() << " scenes and " << plan.seeds.size() << " seeds ("
           << plan.seeds.front() << " to " << plan.seeds.back() << "): " << results.records.size()
           << " measurements. All sticks are simulated. Measured by:\n\n";
  for (const std::string& machine : results.machines) markdown << "- " << machine << "\n";
  markdown
      << "\nTimes are those of the picture of a new volume (pass 1 with the reconstruction before "
         "it, to pass 4; of all threads), as ratios to the reference's, which was rendered in "
         "turn with each, median of "
      << plan.repeats
      << " a measurement, geometric mean over scenes and seeds. Errors: mean over scenes and "
         "seeds ± 95 % interval. All measurements are in `trade.csv`.\n";
  if (results.refused > 0) {
    markdown << "\n"
             << results.refused
             << " points are combinations that were refused, the first: " << results.first_refusal
             << "\n";
  }
}

/// How long an evaluation takes, and its parts.
void write_evaluation(const TradeResults& results, std::ostream& markdown) {
  std::vector<double> all, renderer, render, measure;
  for (const auto& [unit, record] : results.records) {
    const EvaluationTimes& times = record.evaluation;
    const double sum = times.renderer_ms + times.render_ms + times.truth_ms + times.measure_ms;
    if (sum <= 0) continue;  // refused, or of a journal that has no such times
    all.push_back(sum);
    renderer.push_back(times.renderer_ms);
    render.push_back(times.render_ms);
    measure.push_back(times.measure_ms);
  }
  if (all.empty()) return;
  const Quartiles quartiles = quartiles_of(all);
  const auto median = [](const std::vector<double>& times) {
    return fixed(quantile(times, 0.5), 0) + " ms";
  };
  markdown << "\nAn evaluation (a setting's first picture and its measures, without the timing in "
              "turn) took "
           << fixed(quartiles.median, 0) << " ms (quartiles " << fixed(quartiles.lower, 0) << " to "
           << fixed(quartiles.upper, 0) << "), that is " << fixed(1000 / quartiles.median, 1)
           << " a second: medians " << median(renderer) << " for the renderer, " << median(render)
           << " for the picture with its shaders and pass 1, " << median(measure)
           << " for the measures.\n";
}

void write_row(const TradeResults& results, const TradeScore& score, std::ostream& markdown) {
  const auto cell = [&](const char* name, int digits) {
    markdown << " | " << interval_text(score.measures[trade_measure(name)], digits);
  };
  markdown << "| " << score.point << " | " << fixed(score.volume_ratio, 2) << " | "
           << fixed(score.view_ratio, 2) << " | " << fixed(score.volume_ms, 0);
  cell("median_mm", 2);
  cell("p95_mm", 2);
  cell("outside_p95_mm", 2);
  cell("missed_percent", 2);
  cell("false_percent", 2);
  markdown << " | " << point_text(results.work, score.point) << " |\n";
}

void write_front(const TradeResults& results,
                 const TradeResults::Part& part,
                 std::ostream& markdown) {
  markdown
      << "\n| point | time | of a new view | ms | median, mm | P95, mm | outside silhouettes, mm "
         "| missed, % | false, % | setting |\n"
         "| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |\n";
  for (const std::size_t i : part.front) write_row(results, part.scores[i], markdown);
}

/// A sentence for each knee, with what changed since the one before.
void write_knees(const TradeResults& results,
                 const TradeResults::Part& part,
                 std::ostream& markdown) {
  const TradeScore* before = nullptr;
  markdown << "\nKnees, of the points with at most " << fixed(kMostWrongPercent, 0)
           << " % missed or false:\n\n";
  for (const TradeKnee& knee : part.knees) {
    const TradeScore& score = part.scores[knee.score];
    markdown << "- At " << fixed(score.volume_ratio, 2) << " of the reference's time (point "
             << score.point << ": "
             << point_text(results.work, score.point, before ? &before->point : nullptr)
             << ") P95 is " << fixed(score.p95_mm(), 2) << " mm, missed or false "
             << fixed(score.wrong_percent(), 2) << " %. Each per cent of time took "
             << fixed(knee.gain_before, 2) << " % off P95 up to here and takes "
             << fixed(knee.gain_after, 2) << " % beyond.\n";
    before = &score;
  }
}

void write_part(const TradeResults& results,
                const TradeResults::Part& part,
                std::ostream& markdown) {
  markdown << "\n## Front: " << part.name << "\n\n"
           << part.front.size() << " of " << part.scores.size()
           << " points are beaten by no other in time, P95 and missed or false together.\n";
  if (const auto figure = trade_figure(part)) {
    markdown << "\n[Chart: " << figure->caption << "](trade_" << figure->name << ".vl.json)\n";
  }
  write_front(results, part, markdown);
  if (!part.knees.empty()) write_knees(results, part, markdown);
}

void write_effects(const TradeResults& results,
                   const std::vector<TradeScore>& scores,
                   std::ostream& markdown) {
  const auto& axes = results.work.plan.axes;
  markdown
      << "\n## Effects of single settings\n\n"
         "The mean over the points with a value less that over all others, ± 95 %. In brackets: "
         "not told from 0.\n\n| setting | value ";
  std::vector<std::vector<LevelEffect>> effects;
  for (const TradeResponse response : kTradeResponses) {
    markdown << "| " << name_of(response) << " ";
    effects.push_back(level_effects(results.work, scores, response));
  }
  markdown << "|\n| --- | --- | ---: | ---: | ---: |\n";
  for (std::size_t i = 0; i < effects.front().size(); ++i) {
    const LevelEffect& first = effects.front()[i];
    markdown << "| `" << axes[first.axis].key << "` | " << axes[first.axis].levels[first.level];
    for (const auto& of_response : effects) {
      const MeanInterval& effect = of_response[i].effect;
      const std::string text = interval_text(effect, 2);
      markdown << " | " << (effect.differs_from_zero() ? text : "(" + text + ")");
    }
    markdown << " |\n";
  }
}

/// Numbers `from` to `to`, by their largest share of a response.
std::vector<std::size_t> by_share(const std::vector<std::vector<VarianceShare>>& shares,
                                  std::size_t from,
                                  std::size_t to) {
  const auto largest = [&](std::size_t i) {
    double most = -1;
    for (const auto& of_response : shares) most = std::max(most, of_response[i].share);
    return most;
  };
  std::vector<std::size_t> order;
  for (std::size_t i = from; i < to; ++i) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return largest(a) > largest(b);
  });
  return order;
}

void write_shares(const TradeResults& results,
                  const std::vector<TradeScore>& scores,
                  std::ostream& markdown) {
  const auto& axes = results.work.plan.axes;
  std::vector<std::vector<VarianceShare>> shares;
  markdown
      << "\n## Which settings matter\n\n"
         "Share of the variance over the points (omega squared, %) ± 95 %: of single settings, "
         "then of the pairs that matter most, beyond what each does alone.\n\n| setting";
  for (const TradeResponse response : kTradeResponses) {
    markdown << " | " << name_of(response);
    shares.push_back(variance_shares(results.work, scores, response));
  }
  markdown << " |\n| --- | ---: | ---: | ---: |\n";
  std::vector<std::size_t> order = by_share(shares, 0, axes.size());
  const auto pairs = by_share(shares, axes.size(), shares.front().size());
  order.insert(order.end(),
               pairs.begin(),
               pairs.begin() + std::min<std::ptrdiff_t>(kMostInteractions, std::ssize(pairs)));
  for (const std::size_t i : order) {
    const VarianceShare& first = shares.front()[i];
    markdown << "| `" << axes[first.axis].key << "`";
    if (first.other != first.axis) markdown << " × `" << axes[first.other].key << "`";
    for (const auto& of_response : shares) {
      const VarianceShare& share = of_response[i];
      markdown << " | " << fixed(100 * share.share, 1) << " ± " << fixed(100 * share.half, 1);
    }
    markdown << " |\n";
  }
}

}  // namespace

TradeResults trade_results(TradeWork work, TradeContent content) {
  TradeResults results{
      std::move(work), std::move(content.records), std::move(content.machines), {}, 0, {}};
  const auto& scenes = results.work.plan.scenes;
  if (scenes.size() > 1) {
    results.parts.push_back(part_of(results, "all scenes", all_scenes(results.work.plan)));
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

std::string measured_by(const Provenance& provenance) {
  return "commit " + provenance.commit + ", " + machine_text(provenance);
}

std::string point_text(const TradeWork& work, std::size_t point, const std::size_t* from) {
  std::string text;
  for (std::size_t i = 0; i < work.plan.axes.size(); ++i) {
    const std::string& value = work.points[point].values[i];
    if (from != nullptr && work.points[*from].values[i] == value) continue;
    const std::string& key = work.plan.axes[i].key;
    text += (text.empty() ? "" : ", ") + key.substr(key.rfind('.') + 1) + " " + plain_value(value);
  }
  return text.empty() ? "the same setting" : text;
}

std::string trade_markdown(const TradeResults& results) {
  std::ostringstream markdown;
  write_head(results, markdown);
  write_evaluation(results, markdown);
  for (const TradeResults::Part& part : results.parts) write_part(results, part, markdown);
  const auto& scores = results.parts.front().scores;
  if (scores.size() > results.work.plan.axes.size()) {
    write_effects(results, scores, markdown);
    write_shares(results, scores, markdown);
  }
  return markdown.str();
}

}  // namespace wobblebench::bench
