#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "base/number_text.h"
#include "base/units.h"
#include "bench/studies/accuracy/accuracy_report.h"

namespace wobblebench::bench {

namespace {

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

std::string text_of(const MeanInterval& interval, int digits) {
  if (interval.n == 0) return "";
  std::string text = fixed(interval.mean, digits);
  return std::isfinite(interval.half) ? text + " ± " + fixed(interval.half, digits) : text;
}

/// Differences that their interval does not tell from 0 are in brackets.
std::string difference_text(const MeanInterval& interval, int digits) {
  std::string text = text_of(interval, digits);
  if (text.empty()) return text;
  return interval.differs_from_zero() ? text : "(" + text + ")";
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
             << text_of(s.render_ms, 0) << " | " << text_of(s.render_ratio, 2) << " ";
    write_cells(s.means, picture_columns(), text_of, markdown);
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
    write_cells(s.means, region_columns(), text_of, markdown);
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
               << " | " << s.setting << " | " << text_of(rms, 2) << " | "
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

}  // namespace

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

}  // namespace wobblebench::bench
