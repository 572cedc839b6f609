#include "bench/studies/accuracy/accuracy_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "base/number_text.h"
#include "base/units.h"
#include "bench/output/image_io.h"
#include "bench/output/picture/canvas.h"
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

/// A column: which measure, its heading, and its digits after the decimal point.
struct Column {
  std::string measure;
  std::string heading;
  int digits;
};

const std::vector<Column>& picture_columns() {
  static const std::vector<Column> columns = {{"median_mm", "median, mm", 2},
                                              {"rms_mm", "RMS, mm", 2},
                                              {"p95_mm", "P95, mm", 2},
                                              {"missed_percent", "missed, %", 2},
                                              {"missed_surface_percent", "of the surface, %", 2},
                                              {"false_percent", "false, %", 2},
                                              {"false_surface_percent", "of what is found, %", 2},
                                              {"normal_median_deg", "normal, median, deg", 1},
                                              {"distance_mean_mm", "distance, mean, mm", 2},
                                              {"hausdorff95_mm", "Hausdorff 95, mm", 2},
                                              {"ssim", "SSIM", 3}};
  return columns;
}

const std::vector<Column>& region_columns() {
  static const std::vector<Column> columns = {{"surface_percent", "of the picture, %", 1},
                                              {"median_mm", "median, mm", 2},
                                              {"rms_mm", "RMS, mm", 2},
                                              {"p95_mm", "P95, mm", 2},
                                              {"missed_percent", "missed, %", 2},
                                              {"missed_surface_percent", "of the surface, %", 2},
                                              {"false_percent", "false, %", 2},
                                              {"normal_median_deg", "normal, median, deg", 1}};
  return columns;
}

std::size_t index_of(const std::string& measure) {
  const auto& names = measure_names();
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), measure) - names.begin());
}

void write_heading(const std::vector<std::string>& first,
                   const std::vector<Column>& columns,
                   std::ostream& markdown) {
  for (const std::string& name : first) markdown << "| " << name << " ";
  for (const Column& column : columns) markdown << "| " << column.heading << " ";
  markdown << "|\n";
  for (std::size_t i = 0; i < first.size(); ++i) markdown << "| --- ";
  for (std::size_t i = 0; i < columns.size(); ++i) markdown << "| ---: ";
  markdown << "|\n";
}

template <class Text>
void write_cells(const std::vector<MeanInterval>& intervals,
                 const std::vector<Column>& columns,
                 const Text& text,
                 std::ostream& markdown) {
  for (const Column& column : columns) {
    markdown << "| " << text(intervals[index_of(column.measure)], column.digits) << " ";
  }
  markdown << "|\n";
}

void write_pictures(const AccuracyResults& results, std::ostream& markdown) {
  markdown << "\n## Whole pictures\n\nms: of a new volume, all passes, each setting in turn for "
              "each seed; and over that of the first setting, seed by seed.\n\n";
  write_heading({"scene", "rung", "setting", "ms", "times the first"}, picture_columns(), markdown);
  for (const AccuracySummary& s : results.summaries) {
    if (s.group != "picture") continue;
    markdown << "| " << s.scene << " | " << s.rung << " | " << s.setting << " | "
             << interval_text(s.render_ms, 0) << " | " << interval_text(s.render_ratio, 2) << " ";
    write_cells(s.means, picture_columns(), interval_text, markdown);
  }
}

void write_differences(const AccuracyResults& results, std::ostream& markdown) {
  const bool compared = std::any_of(results.summaries.begin(),
                                    results.summaries.end(),
                                    [](const auto& s) { return !s.differences.empty(); });
  if (!compared) return;
  markdown << "\n## Differences to " << results.rows.front().setting
           << "\n\nOf the same seeds, pair by pair. In brackets: no larger than its interval.\n\n";
  write_heading({"scene", "rung", "setting"}, picture_columns(), markdown);
  for (const AccuracySummary& s : results.summaries) {
    if (s.group != "picture" || s.differences.empty()) continue;
    markdown << "| " << s.scene << " | " << s.rung << " | " << s.setting << " ";
    write_cells(s.differences, picture_columns(), difference_text, markdown);
  }
}

void write_regions(const AccuracyResults& results,
                   const std::string& group,
                   const std::string& title,
                   std::ostream& markdown) {
  const bool any = std::any_of(results.summaries.begin(),
                               results.summaries.end(),
                               [&](const auto& s) { return s.group == group; });
  if (!any) return;
  markdown << "\n## " << title << "\n\n";
  write_heading({"scene", "rung", "setting", group}, region_columns(), markdown);
  for (const AccuracySummary& s : results.summaries) {
    if (s.group != group) continue;
    markdown << "| " << s.scene << " | " << s.rung << " | " << s.setting << " | " << s.region
             << " ";
    write_cells(s.means, region_columns(), interval_text, markdown);
  }
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

std::string left_out(const SpacingError& spacing) {
  return std::to_string(spacing.hidden) + ", " + std::to_string(spacing.outside) + ", " +
         std::to_string(spacing.parted);
}

/// RMS errors outside the band over what a perfect detector could reach.
void write_bounds(const AccuracyResults& results, std::ostream& markdown) {
  if (results.bounds.empty()) return;
  markdown
      << "\n## Against the bound\n\nRMS outside the band over the yardstick of decision 30: a "
         "perfect "
         "detector on each stick, straight lines between them. Left out of the yardstick, but not "
         "of the RMS: pixels whose point lies behind what its stick meets (hidden), that are "
         "not between four sticks that meet a surface (outside), or whose surface does not "
         "run on to all four (parted).\n\n"
         "| scene | sticks, mm | spacing, mm | yardstick, mm | pixels | hidden, outside, parted | "
         "rung | "
         "setting | RMS, mm | "
         "ratio |\n| --- | ---: | ---: | ---: | ---: | ---: | --- | --- | ---: | ---: |\n";
  for (const AccuracyBound& bound : results.bounds) {
    for (const AccuracySummary& s : results.summaries) {
      if (s.group != "picture" || s.scene != bound.scene) continue;
      const AccuracySummary* outside = outside_band(results, s);
      if (outside == nullptr) continue;
      const MeanInterval rms = outside->means[index_of("rms_mm")];
      const double yardstick_mm = bound.yardstick_m() / kMillimetre;
      markdown << "| " << s.scene << " | " << fixed(bound.sticks_m / kMillimetre, 3) << " | "
               << fixed(bound.spacing.rms_m / kMillimetre, 3) << " | " << fixed(yardstick_mm, 3)
               << " | " << bound.spacing.n << " | " << left_out(bound.spacing) << " | " << s.rung
               << " | " << s.setting << " | " << interval_text(rms, 2) << " | "
               << fixed(rms.mean / yardstick_mm, 2) << " |\n";
    }
  }
}

void write_sheet(const AccuracyResults& results, std::ostream& markdown) {
  markdown << "\n## Pictures of seed " << results.seeds.front()
           << "\n\nEach also as a file of its own, `accuracy_SCENE_RUNG_SETTING.png`.\n\n"
           << "![Every scene and rung, by each setting, and the true surface shaded alike.]("
           << kAccuracySheet << ")\n";
}

constexpr int kSide = 150, kGap = 6, kTop = 26, kLeft = 120;
constexpr double kText = 13;

/// In the order of their first picture, the truth last.
std::vector<std::string> columns_of(const AccuracyResults& results) {
  std::vector<std::string> names;
  for (const AccuracyPicture& picture : results.pictures) {
    if (picture.setting == "truth") continue;
    if (std::find(names.begin(), names.end(), picture.setting) == names.end()) {
      names.push_back(picture.setting);
    }
  }
  names.emplace_back("truth");
  return names;
}

std::vector<std::pair<std::string, std::string>> rows_of(const AccuracyResults& results) {
  std::vector<std::pair<std::string, std::string>> rows;
  for (const AccuracyPicture& picture : results.pictures) {
    const std::pair row{picture.scene, picture.rung};
    if (std::find(rows.begin(), rows.end(), row) == rows.end()) rows.push_back(row);
  }
  return rows;
}

template <class Values, class Value>
int number_of(const Values& values, const Value& value) {
  return static_cast<int>(std::find(values.begin(), values.end(), value) - values.begin());
}

Image<glm::vec3> displayed(Image<glm::vec3> light) {
  for (glm::vec3& pixel : light.pixels) {
    pixel = {encoded(pixel.r), encoded(pixel.g), encoded(pixel.b)};
  }
  return light;
}

}  // namespace

std::string interval_text(const MeanInterval& interval, int digits) {
  if (interval.n == 0) return "";
  const std::string mean = fixed(interval.mean, digits);
  return std::isfinite(interval.half) ? mean + " ± " + fixed(interval.half, digits) : mean;
}

std::string difference_text(const MeanInterval& interval, int digits) {
  const std::string text = interval_text(interval, digits);
  return text.empty() || interval.differs_from_zero() ? text : "(" + text + ")";
}

std::string csv_number(double value) {
  constexpr int kDigits = 7;
  return std::isfinite(value) ? significant(value, kDigits) : "";
}

std::string accuracy_csv(const AccuracyResults& results) {
  std::ostringstream csv;
  csv << "scene,rung,setting,seed,group,region";
  for (const std::string& name : measure_names()) csv << "," << name;
  csv << ",render_ms\n";
  for (const AccuracyRow& row : results.rows) {
    csv << row.scene << "," << row.rung << "," << row.setting << "," << row.seed << ","
        << row.measures.group << "," << row.measures.region;
    for (const double value : row.measures.values) csv << "," << csv_number(value);
    csv << "," << csv_number(row.render_ms) << "\n";
  }
  return csv.str();
}

std::string accuracy_picture_file(const AccuracyPicture& picture) {
  return "accuracy_" + picture.scene + "_" + picture.rung + "_" + picture.setting + ".png";
}

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

std::string accuracy_markdown(const AccuracyResults& results, const Provenance& provenance) {
  std::ostringstream markdown;
  markdown << "# Accuracy\n\nMade by `wobblebench accuracy`. Commit " << provenance.commit << ", "
           << provenance.cpu << ", " << provenance.gl_renderer << ". Seeds "
           << results.seeds.front() << " to " << results.seeds.back()
           << "; mean ± half of the 95 % interval (Student's t). What is measured, and how: "
              "decision 28. All rows are in `accuracy.csv`.\n";
  for (const std::string& note : results.notes) markdown << "\n" << note << ".\n";
  write_pictures(results, markdown);
  write_differences(results, markdown);
  write_regions(results, "silhouette", "Outside and within the band at silhouettes", markdown);
  write_bounds(results, markdown);
  write_regions(results, "incidence", "By incidence, degrees", markdown);
  write_regions(results, "range", "By range, mm", markdown);
  write_regions(results, "feature", "By feature", markdown);
  write_regions(results, "unseen", "What the probe cannot see", markdown);
  write_sheet(results, markdown);
  return markdown.str();
}

Image<glm::vec3> accuracy_sheet(const AccuracyResults& results) {
  const auto columns = columns_of(results);
  const auto rows = rows_of(results);
  const auto at = [](int number) { return number * (kSide + kGap); };
  Canvas canvas(kLeft + at(static_cast<int>(columns.size())),
                kTop + at(static_cast<int>(rows.size())));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const double middle = kLeft + at(static_cast<int>(i)) + 0.5 * kSide;
    canvas.text({middle, 0.5 * kTop}, columns[i], {.size = kText, .across = 0.5});
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double middle = kTop + at(static_cast<int>(i)) + 0.5 * kSide;
    canvas.text({kGap, middle - 10}, rows[i].first, {.size = kText});
    canvas.text({kGap, middle + 10}, rows[i].second, {.size = kText});
  }
  for (const AccuracyPicture& picture : results.pictures) {
    const Point2 corner(kLeft + at(number_of(columns, picture.setting)),
                        kTop + at(number_of(rows, std::pair(picture.scene, picture.rung))));
    canvas.picture({corner, corner + Point2(kSide, kSide)}, displayed(picture.surface));
  }
  return canvas.finish();
}

}  // namespace wobblebench::bench
