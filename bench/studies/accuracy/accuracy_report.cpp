#include "bench/studies/accuracy/accuracy_report.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/units.h"
#include "bench/evaluation/bootstrap.h"
#include "bench/output/report_parts.h"

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
    json[measure_names()[i]] = interval_json(interval);
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

/// Of whole pictures; the keys are names of measures.
const std::vector<Column>& picture_columns() {
  static const std::vector<Column> columns = {
      {"median_mm", "median", "mm"},
      {"rms_mm", "RMS", "mm"},
      {"p95_mm", "P95", "mm"},
      {"outliers_percent", "beyond 10 mm", "%"},
      {"missed_percent", "missed", "%"},
      {"missed_surface_percent", "of the surface", "%"},
      {"false_percent", "false", "%"},
      {"false_surface_percent", "of what is found", "%"},
      {"grazing_missed_percent", "of grazing missed", "%", 0},
      {"normal_median_deg", "normal, median", "deg", 1},
      {"distance_mean_mm", "distance, mean", "mm"},
      {"hausdorff95_mm", "Hausdorff 95", "mm"},
      {"ssim", "SSIM", "", 3}};
  return columns;
}

const std::vector<Column>& region_columns() {
  static const std::vector<Column> columns = {{"surface_percent", "of the picture", "%", 1},
                                              {"median_mm", "median", "mm"},
                                              {"rms_mm", "RMS", "mm"},
                                              {"p95_mm", "P95", "mm"},
                                              {"missed_percent", "missed", "%"},
                                              {"missed_surface_percent", "of the surface", "%"},
                                              {"false_percent", "false", "%"},
                                              {"normal_median_deg", "normal, median", "deg", 1}};
  return columns;
}

std::vector<Column> name_columns() {
  return {{"scene"}, {"rung"}, {"setting"}};
}

std::vector<Column> joined(std::vector<Column> columns, const std::vector<Column>& more) {
  columns.insert(columns.end(), more.begin(), more.end());
  return columns;
}

std::size_t index_of(const std::string& measure) {
  const auto& names = measure_names();
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), measure) - names.begin());
}

/// A summary's scene, rung and setting.
std::vector<Cell> names_of(const AccuracySummary& s) {
  return {s.scene, s.rung, s.setting};
}

/// Appends a cell for each of the columns.
void append(const std::vector<MeanInterval>& intervals,
            const std::vector<Column>& columns,
            Cell (*cell)(const MeanInterval&),
            std::vector<Cell>& row) {
  for (const Column& column : columns) row.push_back(cell(intervals[index_of(column.key)]));
}

/// Names a summary of a whole picture in charts and tables.
std::string id_of(const AccuracySummary& s) {
  return s.scene + "-" + s.rung + "-" + s.setting;
}

Table picture_table(const AccuracyResults& results) {
  Table table{.name = "pictures",
              .columns = joined(
                  joined(name_columns(),
                         {{"render_ms", "time", "ms", 0}, {"times_the_first", "times the first"}}),
                  picture_columns())};
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
  Table table{.name = "differences", .columns = joined(name_columns(), picture_columns())};
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
  Table table{.name = group,
              .columns = joined(joined(name_columns(), {{group}}), region_columns())};
  for (const AccuracySummary& s : results.summaries) {
    if (s.group != group) continue;
    std::vector<Cell> row = names_of(s);
    row.emplace_back(s.region);
    append(s.means, region_columns(), interval_cell, row);
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
  Table table{.name = "bound",
              .columns = {{"scene"},
                          {"sticks_mm", "sticks", "mm", 3},
                          {"spacing_mm", "spacing", "mm", 3},
                          {"yardstick_mm", "yardstick", "mm", 3},
                          {"pixels"},
                          {"hidden"},
                          {"outside"},
                          {"parted"},
                          {"rung"},
                          {"setting"},
                          {"rms_mm", "RMS", "mm"},
                          {"ratio"}}};
  for (const AccuracyBound& bound : results.bounds) {
    for (const AccuracySummary& s : results.summaries) {
      if (s.group != "picture" || s.scene != bound.scene) continue;
      const AccuracySummary* outside = outside_band(results, s);
      if (outside == nullptr) continue;
      const MeanInterval rms = outside->means[index_of("rms_mm")];
      const double yardstick_mm = bound.yardstick_m() / kMillimetre;
      table.add({s.scene,
                 bound.sticks_m / kMillimetre,
                 bound.spacing.rms_m / kMillimetre,
                 yardstick_mm,
                 bound.spacing.n,
                 bound.spacing.hidden,
                 bound.spacing.outside,
                 bound.spacing.parted,
                 s.rung,
                 s.setting,
                 interval_cell(rms),
                 rms.mean / yardstick_mm});
    }
  }
  return table;
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

/// Each value once, in the order of the summaries.
std::vector<std::string> different(const AccuracyResults& results,
                                   std::string AccuracySummary::*name) {
  std::vector<std::string> values;
  for (const AccuracySummary& s : results.summaries) {
    if (std::find(values.begin(), values.end(), s.*name) == values.end()) values.push_back(s.*name);
  }
  return values;
}

/// Charts of one rung: settings along the axis and a series for each scene, or the other way round
/// where there is one setting alone.
class RungCharts {
 public:
  RungCharts(const AccuracyResults& results, std::string rung)
      : results_(results), rung_(std::move(rung)) {
    if (different(results, &AccuracySummary::setting).size() < 2) std::swap(along_, apart_);
    names_ = different(results, along_);
  }

  Figure figure() const {
    const std::size_t seeds = results_.seeds.size();
    const bool of_settings = along_ == &AccuracySummary::setting;
    Figure figure{
        .name = "errors_" + rung_,
        .caption =
            std::string("Errors by ") + (of_settings ? "setting and scene" : "scene") + ", rung " +
            rung_ +
            (results_.of_population ? ": means over the scenes of each with 95 % intervals."
             : seeds > 1 ? ": means over " + std::to_string(seeds) + " seeds with 95 % intervals."
                         : ", of one seed.")};
    for (const char* measure : {"median_mm", "p95_mm", "missed_percent", "false_percent"}) {
      figure.panels.emplace_back(chart(measure));
    }
    return figure;
  }

 private:
  Chart chart(const std::string& measure) const {
    const auto& column = *std::find_if(picture_columns().begin(),
                                       picture_columns().end(),
                                       [&](const auto& other) { return other.key == measure; });
    const bool of_depth = column.unit == "mm";
    Chart chart{
        .title = of_depth ? "Depth error, " + column.title : "Surface that is " + column.title,
        .x = {.label = along_ == &AccuracySummary::setting ? "setting" : "scene", .names = names_},
        .y = {.label = column.title + (of_depth ? " (mm)" : " (% of the picture)")}};
    const double least = of_depth ? -std::numeric_limits<double>::infinity() : 0;
    if (!of_depth) chart.y.low = least;
    const auto all = different(results_, apart_);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double apart = std::min(kMostApart, kRoom / static_cast<double>(all.size()));
      const double offset = apart * (static_cast<double>(i) - 0.5 * (double(all.size()) - 1));
      chart.series.push_back(series(all[i], index_of(measure), offset, least));
      chart.series.back().mark = kMarks[i % std::size(kMarks)];
    }
    if (!of_depth && shows_zeros_alone(chart)) chart.y.high = 1;
    return chart;
  }

  static bool shows_zeros_alone(const Chart& chart) {
    return std::all_of(chart.series.begin(), chart.series.end(), [](const Series& series) {
      return std::none_of(series.y.begin(), series.y.end(), [](double y) { return y > 0; });
    });
  }

  /// No end of an interval is less than `least`.
  Series series(const std::string& name, std::size_t measure, double offset, double least) const {
    Series series{.name = name, .stroke = Stroke::none};
    for (const AccuracySummary& s : results_.summaries) {
      if (s.group != "picture" || s.rung != rung_ || s.*apart_ != name) continue;
      const auto at = std::find(names_.begin(), names_.end(), s.*along_) - names_.begin();
      const MeanInterval& value = s.means[measure];
      series.add(static_cast<double>(at) + offset, value.mean);
      series.low.push_back(std::max(least, value.mean - value.half));
      series.high.push_back(value.mean + value.half);
      series.ids.push_back(id_of(s));
    }
    return series;
  }

  static constexpr double kMostApart = 0.12, kRoom = 0.8;
  static constexpr Mark kMarks[] = {Mark::disc, Mark::square, Mark::triangle, Mark::diamond};

  const AccuracyResults& results_;
  std::string rung_;
  std::string AccuracySummary::*along_ = &AccuracySummary::setting;
  std::string AccuracySummary::*apart_ = &AccuracySummary::scene;
  std::vector<std::string> names_;
};

/// More pictures than these are on the sheet alone, or the page would have many megabytes.
constexpr std::size_t kMostPictures = 40;

/// What a click on a summary of a whole picture shows.
void add_details(const AccuracyResults& results, Document& document) {
  for (const AccuracySummary& s : results.summaries) {
    if (s.group != "picture") continue;
    Detail detail{.id = id_of(s), .title = s.scene + ", " + s.rung + ", " + s.setting};
    const auto command = results.commands.find({s.scene, s.rung, s.setting});
    if (command != results.commands.end()) detail.command = command->second;
    for (const Column& column : picture_columns()) {
      const std::string shown = interval_cell(s.means[index_of(column.key)]).shown(column);
      if (!shown.empty()) detail.text += "- " + heading(column) + ": " + shown + "\n";
    }
    if (results.pictures.size() <= kMostPictures) {
      detail.picture_file = accuracy_picture_file({s.scene, s.rung, s.setting, {}});
    }
    document.add(std::move(detail));
  }
}

Table rows_table(const AccuracyResults& results) {
  Table table{.name = "rows",
              .columns = {{"scene"}, {"rung"}, {"setting"}, {"seed"}, {"group"}, {"region"}}};
  for (const std::string& name : measure_names()) table.columns.push_back({name});
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
  std::string text = "Made by `wobblebench accuracy`. Commit " + provenance.commit + ", " +
                     provenance.cpu + ", " + provenance.gl_renderer + ". " + seeds_text(results) +
                     "; mean ± half of the 95 % interval (Student's t). What is measured, and how: "
                     "decision 28. All rows are in `accuracy.csv`.\n";
  for (const std::string& note : results.notes) text += "\n" + note + ".\n";
  return text;
}

/// The measures of the table of strata.
const std::vector<Column>& stratum_columns() {
  static const std::vector<Column> columns = {
      {"median_mm", "median", "mm"},
      {"p95_mm", "P95", "mm"},
      {"missed_surface_percent", "missed of the surface", "%"},
      {"false_surface_percent", "false of what is found", "%"}};
  return columns;
}

Cell bootstrap_cell(const std::vector<double>& values) {
  const BootstrapMean mean = bootstrap_mean(values);
  return mean.n > 0 ? Cell::spread(mean.mean, mean.low, mean.high) : Cell();
}

/// A measure of the scenes of a summary, by their seeds.
std::map<std::uint64_t, double> measured_of(const AccuracyResults& results,
                                            const AccuracySummary& of,
                                            const std::string& setting,
                                            const std::string& measure) {
  std::map<std::uint64_t, double> values;
  for (const AccuracyRow& row : results.rows) {
    if (row.measures.group != "picture" || row.scene != of.scene || row.rung != of.rung) continue;
    if (row.setting == setting) values[row.seed] = row.measures.values[index_of(measure)];
  }
  return values;
}

/// `reference`: a setting that is subtracted, scene by scene; empty: none.
Table strata_table(const AccuracyResults& results, const std::string& reference) {
  Table table{.name = reference.empty() ? "strata" : "strata_differences",
              .columns = {{"stratum"}, {"rung"}, {"setting"}, {"scenes"}}};
  for (const Column& column : stratum_columns()) table.columns.push_back(column);
  for (const AccuracySummary& s : results.summaries) {
    if (s.group != "picture" || s.setting == reference) continue;
    std::vector<Cell> row = {s.scene, s.rung, s.setting, s.render_ms.n};
    for (const Column& column : stratum_columns()) {
      std::vector<double> values;
      const auto theirs = measured_of(results, s, reference, column.key);
      for (const auto& [seed, value] : measured_of(results, s, s.setting, column.key)) {
        values.push_back(reference.empty() ? value : value - theirs.at(seed));
      }
      row.push_back(bootstrap_cell(values));
    }
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
  document.add(Text{head_text(results, provenance)});
  add_strata(results, document);
  document.add(Heading{"Whole pictures"})
      .add(Text{
          "Time: of a new volume, all passes, each setting in turn for each seed; and over that "
          "of the first setting, seed by seed."});
  for (const std::string& rung : different(results, &AccuracySummary::rung)) {
    document.add(RungCharts(results, rung).figure());
  }
  document.add(picture_table(results));
  add_differences(results, document);
  add_regions(results, "silhouette", "Outside and within the band at silhouettes", document);
  add_bounds(results, document);
  add_regions(results, "incidence", "By incidence, degrees", document);
  add_regions(results, "range", "By range, mm", document);
  add_regions(results, "part", "By part", document);
  add_regions(results, "unseen", "What the probe cannot see", document);
  add_pictures(results, document);
  return document;
}

}  // namespace wobblebench::bench
