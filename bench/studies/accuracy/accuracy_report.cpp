#include "bench/studies/accuracy/accuracy_report.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/number_text.h"
#include "base/units.h"
#include "bench/evaluation/bootstrap.h"
#include "bench/output/document/interval_cells.h"
#include "bench/output/report_parts.h"
#include "bench/results/error.h"
#include "bench/studies/accuracy/accuracy_charts.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

Json interval_json(const MeanInterval& interval) {
  return {
      {"mean", number(interval.mean)}, {"half_interval", number(interval.half)}, {"n", interval.n}};
}

/// Measures that no seed has are left out.
Json intervals_json(const std::vector<MeanInterval>& intervals) {
  Json json = Json::object();
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const MeanInterval& interval = intervals[i];
    if (interval.n == 0) continue;
    json[picture_measures()[i]->key] = interval_json(interval);
  }
  return json;
}

/// Of a new volume, by scene, rung and setting.
Json render_times_json(const AccuracyResults& results) {
  Json list = Json::array();
  for (const AccuracySummary& summary : results.summaries) {
    if (summary.group != "picture") continue;
    list.push_back({{"scene", summary.scene},
                    {"rung", summary.rung},
                    {"setting", summary.setting},
                    {"ms", interval_json(summary.render_ms)},
                    {"times_the_first", interval_json(summary.render_ratio)}});
  }
  return list;
}

constexpr const Measure* kOfRegions[] = {&error::kSurface,
                                         &error::kMedian,
                                         &error::kRms,
                                         &error::kP95,
                                         &error::kMissed,
                                         &error::kMissedSurface,
                                         &error::kFalse,
                                         &error::kNormalMedian};

std::vector<Column> name_columns() {
  return {{"scene"}, {"rung"}, {"setting"}};
}

/// A summary's scene, rung and setting.
std::vector<Cell> names_of(const AccuracySummary& s) {
  return {s.scene, s.rung, s.setting};
}

/// Appends a cell for each of the measures.
void append(const std::vector<MeanInterval>& intervals,
            Chosen measures,
            Cell (*cell)(const MeanInterval&),
            std::vector<Cell>& row) {
  for (const Measure* one : measures) row.push_back(cell(intervals[measure_index(one->key)]));
}

Table picture_table(const AccuracyResults& results) {
  std::vector<Column> first = name_columns();
  first.push_back({"render_ms", "time", "ms", 0});
  first.push_back({"times_the_first", "times the first"});
  Table table{.name = "pictures", .columns = columns_of(std::move(first), picture_columns())};
  for (const AccuracySummary& s : results.summaries) {
    if (s.group != "picture") continue;
    std::vector<Cell> row = names_of(s);
    row.push_back(interval_cell(s.render_ms));
    row.push_back(interval_cell(s.render_ratio));
    append(s.means, picture_columns(), interval_cell, row);
    table.add(std::move(row), id_of(s));
  }
  return table;
}

Table difference_table(const AccuracyResults& results) {
  Table table{.name = "differences", .columns = columns_of(name_columns(), picture_columns())};
  for (const AccuracySummary& s : results.summaries) {
    if (s.group != "picture" || s.differences.empty()) continue;
    std::vector<Cell> row = names_of(s);
    append(s.differences, picture_columns(), difference_cell, row);
    table.add(std::move(row), id_of(s));
  }
  return table;
}

void add_differences(const AccuracyResults& results, Document& document) {
  Table table = difference_table(results);
  if (table.rows.empty()) return;
  document.add(Heading{"Differences to " + results.rows.front().setting})
      .add(Text{"Of the same seeds, pair by pair. In brackets: no larger than its interval."})
      .add(std::move(table));
}

void add_regions(const AccuracyResults& results,
                 const std::string& group,
                 const std::string& title,
                 Document& document) {
  std::vector<Column> first = name_columns();
  first.push_back({group});
  Table table{.name = group, .columns = columns_of(std::move(first), kOfRegions)};
  for (const AccuracySummary& s : results.summaries) {
    if (s.group != group) continue;
    std::vector<Cell> row = names_of(s);
    row.emplace_back(s.region);
    append(s.means, kOfRegions, interval_cell, row);
    table.add(std::move(row));
  }
  if (!table.rows.empty()) document.add(Heading{title}).add(std::move(table));
}

const AccuracySummary* outside_band(const AccuracyResults& results,
                                    const AccuracySummary& picture) {
  for (const AccuracySummary& s : results.summaries) {
    if (s.group == "silhouette" && s.region == "outside" && s.scene == picture.scene &&
        s.rung == picture.rung && s.setting == picture.setting) {
      return &s;
    }
  }
  return nullptr;
}

/// RMS errors outside the band over what a perfect detector could reach.
Table bound_table(const AccuracyResults& results) {
  struct Row {
    const AccuracyBound& bound;
    const AccuracySummary& picture;
    MeanInterval rms_mm;
  };
  std::vector<Row> rows;
  for (const AccuracyBound& bound : results.bounds) {
    for (const AccuracySummary& s : results.summaries) {
      if (s.group != "picture" || s.scene != bound.scene) continue;
      const AccuracySummary* outside = outside_band(results, s);
      if (outside) rows.push_back({bound, s, outside->means[measure_index(error::kRms.key)]});
    }
  }
  using R = Row;
  const auto mm = [](double metres) { return metres / kMillimetre; };
  return table_of<R>(
      {.name = "bound"},
      rows,
      {{{"scene"}, [](const R& of) { return of.picture.scene; }},
       {{"sticks_mm", "sticks", "mm", 3}, [=](const R& of) { return mm(of.bound.sticks_m); }},
       {{"spacing_mm", "spacing", "mm", 3},
        [=](const R& of) { return mm(of.bound.spacing.rms_m); }},
       {{"yardstick_mm", "yardstick", "mm", 3},
        [=](const R& of) { return mm(of.bound.yardstick_m()); }},
       {{"pixels"}, [](const R& of) { return of.bound.spacing.n; }},
       {{"hidden"}, [](const R& of) { return of.bound.spacing.hidden; }},
       {{"outside"}, [](const R& of) { return of.bound.spacing.outside; }},
       {{"parted"}, [](const R& of) { return of.bound.spacing.parted; }},
       {{"rung"}, [](const R& of) { return of.picture.rung; }},
       {{"setting"}, [](const R& of) { return of.picture.setting; }},
       {column_of(error::kRms), [](const R& of) { return interval_cell(of.rms_mm); }},
       {{"ratio"}, [=](const R& of) { return of.rms_mm.mean / mm(of.bound.yardstick_m()); }}});
}

void add_bounds(const AccuracyResults& results, Document& document) {
  if (results.bounds.empty()) return;
  document.add(Heading{"Against the bound"})
      .add(
          Text{"RMS outside the band over the yardstick of decision 30: a perfect detector on each "
               "stick, straight lines between them. Left out of the yardstick, but not of the RMS: "
               "pixels whose point lies behind what its stick meets (hidden), that are not between "
               "four sticks that meet a surface (outside), or whose surface does not run on to all "
               "four (parted)."})
      .add(bound_table(results));
}

/// More pictures than these are on the sheet alone, or the page would have many megabytes.
constexpr std::size_t kMostPictures = 40;

/// What a click on a summary of a whole picture shows.
void add_details(const AccuracyResults& results, Document& document) {
  for (const AccuracySummary& s : results.summaries) {
    if (s.group != "picture") continue;
    Detail detail{.id = id_of(s), .title = s.scene + ", " + s.rung + ", " + s.setting};
    const auto command = results.commands.find({s.scene, s.rung, s.setting});
    if (command != results.commands.end()) detail.command = command->second;
    for (const Measure* measure : picture_columns()) {
      const Column column = column_of(*measure);
      const std::string shown = interval_cell(s.means[measure_index(column.key)]).shown(column);
      if (!shown.empty()) detail.text += "- " + heading(column) + ": " + shown + "\n";
    }
    if (results.pictures.size() <= kMostPictures) {
      detail.picture_file = accuracy_picture_file({s.scene, s.rung, s.setting, {}});
    }
    document.add(std::move(detail));
  }
}

Table rows_table(const AccuracyResults& results) {
  Table table{
      .name = "rows",
      .columns = columns_of({{"scene"}, {"rung"}, {"setting"}, {"seed"}, {"group"}, {"region"}},
                            picture_measures())};
  table.columns.push_back({"render_ms"});
  for (const AccuracyRow& row : results.rows) {
    std::vector<Cell> cells = {row.scene,
                               row.rung,
                               row.setting,
                               std::to_string(row.seed),
                               row.measures.group,
                               row.measures.region};
    cells.insert(cells.end(), row.measures.values.begin(), row.measures.values.end());
    cells.emplace_back(row.render_ms);
    table.add(std::move(cells));
  }
  return table;
}

std::string seeds_text(const AccuracyResults& results) {
  if (results.of_population) {
    return "Scenes are the strata of a population, whose scenes have a seed each, in "
           "`accuracy.csv`";
  }
  return "Seeds " + std::to_string(results.seeds.front()) + " to " +
         std::to_string(results.seeds.back());
}

std::string head_text(const AccuracyResults& results, const Provenance& provenance) {
  return "Made by `wobblebench accuracy`. Commit " + provenance.commit + ", " + provenance.cpu +
         ", " + provenance.gl_renderer + ". " + seeds_text(results) +
         "; mean ± half of the 95 % interval (Student's t). What is measured, and how: "
         "decision 28. All rows are in `accuracy.csv`.\n";
}

/// The measures of the table of strata.
constexpr const Measure* kOfStrata[] = {
    &error::kMedian, &error::kP95, &error::kMissedSurface, &error::kFalseSurface};

Cell bootstrap_cell(const std::vector<double>& values) {
  const BootstrapMean mean = bootstrap_mean(values);
  return mean.n > 0 ? Cell::spread(mean.mean, mean.low, mean.high) : Cell();
}

/// A measure of the scenes of a summary, by their seeds.
std::map<std::uint64_t, double> measured_of(const AccuracyResults& results,
                                            const AccuracySummary& of,
                                            const std::string& setting,
                                            const Measure& measure) {
  std::map<std::uint64_t, double> values;
  for (const AccuracyRow& row : results.rows) {
    if (row.measures.group != "picture" || row.scene != of.scene || row.rung != of.rung) continue;
    if (row.setting == setting) values[row.seed] = row.measures.values[measure_index(measure.key)];
  }
  return values;
}

/// The greatest P95 of the scenes, which a mean hides; nothing where one of them has none.
Cell worst_cell(const std::map<std::uint64_t, double>& p95_mm) {
  double worst = 0;
  for (const auto& [seed, value] : p95_mm) {
    if (!std::isfinite(value)) return {};
    worst = std::max(worst, value);
  }
  return worst;
}

/// What is compared; then summaries that are of fewer seeds or scenes than were measured, a line
/// each.
std::string asked_text(const AccuracyResults& results) {
  const AccuracySummary& first = results.summaries.front();
  std::string lines =
      "How far what each setting finds is from the true surface (P95: 95 % of the pixels are no "
      "further off): means over scenes, rungs and seeds, against **" +
      first.setting + "**.\n\n";
  for (const std::string& note : results.notes) lines += "- " + note + ".\n";
  for (const AccuracySummary& s : results.summaries) {
    const int with =
        s.group == "picture" ? s.means[measure_index(error::kP95.key)].n : s.render_ms.n;
    if (with == s.render_ms.n) continue;
    lines += "- " + s.scene + ", " + s.rung + ", " + s.setting + ": nothing is found in " +
             std::to_string(s.render_ms.n - with) + " of " + std::to_string(s.render_ms.n) +
             " pictures, which the means of depth leave out.\n";
  }
  return lines;
}

/// `reference`: a setting that is subtracted, scene by scene; empty: none.
Table strata_table(const AccuracyResults& results, const std::string& reference) {
  Table table{.name = reference.empty() ? "strata" : "strata_differences",
              .columns = columns_of({{"stratum"}, {"rung"}, {"setting"}, {"scenes"}}, kOfStrata)};
  if (reference.empty()) table.columns.push_back({"worst_p95_mm", "P95 of the worst scene", "mm"});
  for (const AccuracySummary& s : results.summaries) {
    if (s.group != "picture" || s.setting == reference) continue;
    std::vector<Cell> row = {s.scene, s.rung, s.setting, s.render_ms.n};
    for (const Measure* measure : kOfStrata) {
      std::vector<double> values;
      const auto theirs = measured_of(results, s, reference, *measure);
      for (const auto& [seed, value] : measured_of(results, s, s.setting, *measure)) {
        values.push_back(reference.empty() ? value : value - theirs.at(seed));
      }
      row.push_back(bootstrap_cell(values));
    }
    if (reference.empty())
      row.push_back(worst_cell(measured_of(results, s, s.setting, error::kP95)));
    table.add(std::move(row), id_of(s));
  }
  return table;
}

void add_strata(const AccuracyResults& results, Document& document) {
  if (!results.of_population) return;
  document.add(Heading{"By stratum"})
      .add(Text{
          "Mean over the scenes of a stratum of each scene's own figure, and the 95 % interval "
          "that resampling the scenes gives (bootstrap)."})
      .add(strata_table(results, ""));
  const std::string& reference = results.rows.front().setting;
  Table differences = strata_table(results, reference);
  if (differences.rows.empty()) return;
  document.add(Text{"Less those of " + reference + ", scene by scene."})
      .add(std::move(differences));
}

void add_pictures(const AccuracyResults& results, Document& document) {
  const std::string of = results.of_population ? "the first scene of each stratum"
                                               : "seed " + std::to_string(results.seeds.front());
  document.add(Heading{"Pictures of " + of})
      .add(Text{"Each also as a file of its own, `accuracy_SCENE_RUNG_SETTING.png`."})
      .add(Picture{kAccuracySheet,
                   "Every scene and rung, by each setting, and the true surface shaded alike."});
  add_details(results, document);
}

/// P95 of each setting over scenes and rungs, the one that others are compared with first.
KeyFigures answer_of(const AccuracyResults& results) {
  constexpr std::size_t kMost = 6;
  std::vector<std::string> settings;
  std::map<std::string, std::vector<const AccuracySummary*>> summaries;
  for (const AccuracySummary& s : results.summaries) {
    if (s.group == "picture" && summaries[s.setting].empty()) settings.push_back(s.setting);
    if (s.group == "picture") summaries[s.setting].push_back(&s);
  }
  settings.resize(std::min(settings.size(), kMost));
  KeyFigures figures;
  for (const std::string& setting : settings) {
    const auto mean = [&](auto interval) {
      std::vector<double> values;
      for (const AccuracySummary* s : summaries[setting]) values.push_back(interval(*s).mean);
      return mean_interval(values).mean;
    };
    const auto of = [&](const Measure& measure) {
      return mean([at = measure_index(measure.key)](auto& s) { return s.means[at]; });
    };
    std::string others;
    for (const Measure* measure : {&error::kMedian, &error::kMissed, &error::kFalse}) {
      const Column column = column_of(*measure);
      others += heading(column) + " " + Cell(of(*measure)).shown(column) + "; ";
    }
    const double render_ms = mean([](auto& s) { return s.render_ms; });
    figures.add("P95, " + setting,
                of(error::kP95),
                error::kP95.key,
                others + fixed(render_ms, 0) + " ms for a new volume");
  }
  return figures;
}

}  // namespace

Json accuracy_json(const AccuracyResults& results) {
  Json summaries = Json::array();
  for (const AccuracySummary& summary : results.summaries) {
    Json json = {{"scene", summary.scene},
                 {"rung", summary.rung},
                 {"setting", summary.setting},
                 {"group", summary.group},
                 {"region", summary.region},
                 {"means", intervals_json(summary.means)}};
    if (!summary.differences.empty()) {
      json["differences"] = intervals_json(summary.differences);
    }
    summaries.push_back(std::move(json));
  }
  const EvaluationTimes& times = results.times;
  return {{"seeds", results.seeds},
          {"notes", results.notes},
          {"evaluations", results.evaluations},
          {"render_ms", render_times_json(results)},
          {"evaluation_ms",
           {{"renderer", times.renderer_ms},
            {"render", times.render_ms},
            {"truth", times.truth_ms},
            {"measure", times.measure_ms}}},
          {"summaries", summaries}};
}

Document accuracy_document(const AccuracyResults& results, const Provenance& provenance) {
  Document document{
      .title = "Accuracy", .name = "accuracy", .data = {{"accuracy.csv", rows_table(results)}}};
  document.add(Text{asked_text(results)}).add(answer_of(results));
  add_strata(results, document);
  document.add(Heading{"Whole pictures"})
      .add(Text{
          "Time: of a new volume, all passes, each setting in turn for each seed; and over that "
          "of the first setting, seed by seed."});
  for (const Figure& figure : accuracy_figures(results)) {
    document.add(figure);
  }
  document.add(picture_table(results));
  add_differences(results, document);
  add_regions(results, "silhouette", "Outside and within the band at silhouettes", document);
  add_bounds(results, document);
  add_regions(results, "incidence", "By incidence, degrees", document);
  add_regions(results, "range", "By range, mm", document);
  add_regions(results, "face", "By part of the face", document);
  add_regions(results, "part", "By part", document);
  add_regions(results, "unseen", "What the probe cannot see", document);
  add_pictures(results, document);
  document.add(Heading{"How it was measured"}).add(Text{head_text(results, provenance)});
  return document;
}

}  // namespace wobblebench::bench
