#include "bench/studies/trade/trade_report.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "base/number_text.h"
#include "base/statistics.h"
#include "bench/output/document/interval_cells.h"
#include "bench/results/error.h"

namespace wobblebench::bench {

namespace {

using Part = TradeResults::Part;

Part part_of(const TradeResults& results,
             const std::string& name,
             const std::vector<std::size_t>& scenes) {
  Part part{name, scenes, trade_scores(results.work, results.records, scenes), {}, {}};
  part.front = trade_front(part.scores);
  part.knees = trade_knees(part.scores, part.front);
  return part;
}

constexpr std::ptrdiff_t kMostInteractions = 10;

Column column_of(TradeResponse response) {
  switch (response) {
    case TradeResponse::log2_volume_ratio:
      return {"time_doublings", "time", "doublings"};
    case TradeResponse::p95_mm:
      return column_of(error::kP95);
    case TradeResponse::missed_or_false_percent:
      break;
  }
  return column_of(error::kMissedOrFalse);
}

std::string head_text(const TradeResults& results) {
  const TradePlan& plan = results.work.plan;
  std::string text =
      "Made by `wobblebench trade`. " + std::to_string(results.work.points.size()) + " points on " +
      std::to_string(plan.scenes.size()) + " scenes and " + std::to_string(plan.seeds.size()) +
      " seeds (" + std::to_string(plan.seeds.front()) + " to " + std::to_string(plan.seeds.back()) +
      "): " + std::to_string(results.records.size()) +
      " measurements. All sticks are simulated. Measured by:\n\n";
  for (const std::string& machine : results.machines) text += "- " + machine + "\n";
  text +=
      "\nTimes are those of the picture of a new volume (pass 1 with the reconstruction before it, "
      "to pass 4; of all threads), as ratios to the reference's, which was rendered in turn with "
      "each, median of " +
      std::to_string(plan.repeats) +
      " a measurement, geometric mean over scenes and seeds. Errors: mean over scenes and seeds ± "
      "95 % interval. All measurements are in `trade.csv`.\n";
  if (results.refused > 0) {
    text += "\n" + std::to_string(results.refused) +
            " points are combinations that were refused, the first: " + results.first_refusal +
            "\n";
  }
  return text;
}

/// How long an evaluation takes, and its parts; empty: not known.
std::string evaluation_text(const TradeResults& results) {
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
  if (all.empty()) return "";
  const Quartiles quartiles = quartiles_of(all);
  const auto median = [](const std::vector<double>& times) {
    return fixed(quantile(times, 0.5), 0) + " ms";
  };
  return "An evaluation (a setting's picture of a new volume and its measures, without the "
         "reference's picture in turn) took " +
         fixed(quartiles.median, 0) + " ms (quartiles " + fixed(quartiles.lower, 0) + " to " +
         fixed(quartiles.upper, 0) + "), that is " + fixed(1000 / quartiles.median, 1) +
         " a second: medians " + median(renderer) + " for the renderer, " + median(render) +
         " for the picture with its shaders and pass 1, " + median(measure) + " for the measures.";
}

Table front_table(const TradeResults& results, const Part& part) {
  static constexpr const Measure* kShown[] = {
      &error::kMedian, &error::kP95, &error::kOutsideP95, &error::kMissed, &error::kFalse};
  // Of several scenes the worst beside the mean.
  const bool several = part.scenes.size() > 1;
  std::vector<Column> first = {{"point"}, {"setting"}, {"volume_ratio", "time"}};
  if (several) {
    first.push_back({"worst_p95_mm", "P95 of the worst scene", "mm"});
    first.push_back({"worst_scene", "which"});
  }
  Table table{.name = "front_" + part.file(), .columns = columns_of(std::move(first), kShown)};
  table.columns.push_back({"view_ratio", "time of a new view"});
  table.columns.push_back({"volume_ms", "time", "ms", 0});
  for (const std::size_t i : part.front) {
    const TradeScore& score = part.scores[i];
    std::vector<Cell> row = {
        score.point, point_text(results.work, score.point), score.volume_ratio};
    if (several) {
      const auto& worst = score.worst(error::kP95);
      row.emplace_back(worst.p95_mm());
      row.emplace_back(results.work.plan.scenes[worst.scene].name);
    }
    for (const Measure* measure : kShown) {
      row.push_back(interval_cell(score.measures[trade_measure(measure->key)]));
    }
    row.emplace_back(score.view_ratio);
    row.emplace_back(score.volume_ms);
    table.add(std::move(row), point_id(score.point));
  }
  return table;
}

/// P95 at the ends of the front, at the knees between them, and of the settings that have names.
KeyFigures answer_of(const TradeResults& results, const Part& part) {
  KeyFigures figures;
  const auto add = [&](const std::string& name, const TradeScore& score, const std::string& more) {
    const auto& worst = score.worst(error::kP95);
    const std::string at_most = ", at most " + fixed(worst.p95_mm(), 2) + " on " +
                                results.work.plan.scenes[worst.scene].name;
    figures.add(name,
                score.p95_mm(),
                error::kP95.key,
                "P95 at " + fixed(score.volume_ratio, 2) + " of the time of the plan's reference" +
                    (part.scenes.size() > 1 ? at_most : "") + "; missed or false " +
                    fixed(score.wrong_percent(), 2) + " %; " + more + "point " +
                    std::to_string(score.point) + ": " + point_text(results.work, score.point));
  };
  if (part.front.empty()) return figures;
  add("Fastest", part.scores[part.front.front()], "");
  for (const TradeKnee& knee : part.knees) {
    add("Knee",
        part.scores[knee.score],
        "each per cent more time took " + fixed(knee.gain_before, 2) + " % off P95, and takes " +
            fixed(knee.gain_after, 2) + " % beyond; ");
  }
  const auto p95_mm = [&](std::size_t score) { return part.scores[score].p95_mm(); };
  add("Least P95", part.scores[*std::ranges::min_element(part.front, {}, p95_mm)], "");
  for (const NamedPoint& named : named_points(results.work, part.scenes.front())) {
    const auto score = std::ranges::find(part.scores, named.point, &TradeScore::point);
    if (score != part.scores.end() && named.differs_in.empty()) add(named.name, *score, "");
  }
  return figures;
}

/// Which points the front is of.
std::string front_text(const Part& part) {
  const auto able = std::ranges::count_if(part.scores, finds_surface);
  const std::string most = fixed(kMostWrongPercent, 0) + " % of the picture";
  const std::string of =
      able > 0
          ? "Of the " + std::to_string(able) + " points of " + std::to_string(part.scores.size()) +
                " that miss or invent at most " + most + " on each scene"
          : "**No point of " + std::to_string(part.scores.size()) + " misses and invents at most " +
                most +
                " on each scene**, so that a low P95 here is of what is easy to find. Of all";
  return of + ", " + std::to_string(part.front.size()) +
         " are beaten by no other in time, P95 and missed or false together.";
}

void add_part(const TradeResults& results, const Part& part, Document& document) {
  const bool leads = &part == &results.parts.front();
  if (!leads) document.add(Heading{"Front: " + part.name});
  document.add(Text{front_text(part)}).add(answer_of(results, part));
  if (leads) document.add(Heading{"Front: " + part.name});
  if (!part.front.empty()) document.add(trade_figure(results, part));
  document.add(front_table(results, part));
}

void add_effects(const TradeResults& results,
                 const std::vector<TradeScore>& scores,
                 Document& document) {
  const auto& axes = results.work.plan.axes;
  Table table{.name = "effects", .columns = {{"setting"}, {"value"}}};
  std::vector<std::vector<LevelEffect>> effects;
  for (const TradeResponse response : kTradeResponses) {
    table.columns.push_back(column_of(response));
    effects.push_back(level_effects(results.work, scores, response));
  }
  for (std::size_t i = 0; i < effects.front().size(); ++i) {
    const LevelEffect& first = effects.front()[i];
    std::vector<Cell> row = {Cell::code(axes[first.axis].key),
                             axes[first.axis].levels[first.level]};
    for (const auto& of_response : effects) row.push_back(difference_cell(of_response[i].effect));
    table.add(std::move(row));
  }
  document.add(Heading{"Effects of single settings"})
      .add(Text{"The mean over the points with a value less that over all others, ± 95 %. In "
                "brackets: not told from 0."})
      .add(std::move(table));
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

std::string name_of(const TradeWork& work, const VarianceShare& share) {
  const auto& axes = work.plan.axes;
  if (share.other == share.axis) return axes[share.axis].key;
  return axes[share.axis].key + " × " + axes[share.other].key;
}

void add_shares(const TradeResults& results,
                const std::vector<TradeScore>& scores,
                Document& document) {
  const std::size_t axes = results.work.plan.axes.size();
  Table table{.name = "shares", .columns = {{"setting"}}};
  std::vector<std::vector<VarianceShare>> shares;
  for (const TradeResponse response : kTradeResponses) {
    const Column column = column_of(response);
    table.columns.push_back({"share_" + column.key, column.title, "%", 1});
    shares.push_back(variance_shares(results.work, scores, response));
  }
  std::vector<std::size_t> order = by_share(shares, 0, axes);
  const auto pairs = by_share(shares, axes, shares.front().size());
  order.insert(order.end(),
               pairs.begin(),
               pairs.begin() + std::min<std::ptrdiff_t>(kMostInteractions, std::ssize(pairs)));
  for (const std::size_t i : order) {
    std::vector<Cell> row = {Cell::code(name_of(results.work, shares.front()[i]))};
    for (const auto& of_response : shares) {
      row.push_back(Cell::interval(100 * of_response[i].share, 100 * of_response[i].half));
    }
    table.add(std::move(row));
  }
  document.add(Heading{"Which settings matter"})
      .add(Text{"Share of the variance over the points (omega squared) ± 95 %: of single settings, "
                "then of the pairs that matter most, beyond what each does alone."})
      .add(std::move(table));
}

}  // namespace

namespace {

/// The scenes of each stratum, or each scene alone.
std::vector<std::pair<std::string, std::vector<std::size_t>>> scenes_of_parts(
    const TradePlan& plan) {
  std::vector<std::pair<std::string, std::vector<std::size_t>>> parts;
  for (std::size_t i = 0; i < plan.scenes.size(); ++i) {
    const std::string& name = plan.strata.empty() ? plan.scenes[i].name : plan.strata[i];
    const auto found =
        std::ranges::find(parts, name, &std::pair<std::string, std::vector<std::size_t>>::first);
    if (found == parts.end()) {
      parts.push_back({name, {i}});
    } else {
      found->second.push_back(i);
    }
  }
  return parts;
}

}  // namespace

TradeResults trade_results(TradeWork work, TradeContent content) {
  TradeResults results{
      std::move(work), std::move(content.records), std::move(content.machines), {}, 0, {}};
  const auto& scenes = results.work.plan.scenes;
  if (scenes.size() > 1) {
    results.parts.push_back(part_of(results, "all scenes", all_scenes(results.work.plan)));
  }
  for (const auto& [name, of_part] : scenes_of_parts(results.work.plan)) {
    results.parts.push_back(part_of(results, name, of_part));
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

std::string TradeResults::Part::file() const {
  std::string file = name;
  std::replace(file.begin(), file.end(), ' ', '_');
  return file;
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

Document trade_document(const TradeResults& results, const TradePictures& pictures) {
  Document document{.title = "Trade of time against error",
                    .name = "trade",
                    .data = {{"trade.csv", trade_rows(results)}}};
  for (const Part& part : results.parts) add_part(results, part, document);
  const auto& scores = results.parts.front().scores;
  if (scores.size() > results.work.plan.axes.size()) {
    add_effects(results, scores, document);
    add_shares(results, scores, document);
  }
  document.add(Heading{"How it was measured"}).add(Text{head_text(results)});
  const std::string evaluation = evaluation_text(results);
  if (!evaluation.empty()) document.add(Text{evaluation});
  for (Detail& detail : trade_details(results, pictures)) document.add(std::move(detail));
  return document;
}

}  // namespace wobblebench::bench
