#include "bench/studies/compare/history.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <utility>

#include "base/file.h"
#include "base/statistics.h"
#include "base/user_error.h"
#include "bench/evaluation/seed_statistics.h"
#include "bench/output/report_parts.h"
#include "hw/wire/crc32c.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMostRecordBytes = 100'000'000;
constexpr const char* kTime = "measured_at";

HistoryRecord read_record(const fs::path& file) {
  const Json json = Json::parse(read_file(file, kMostRecordBytes), nullptr, false);
  if (!json.is_object() || !json.contains(kTime) || !json[kTime].is_string()) {
    throw UserError(file.string() + ": is no record of `compare --history`");
  }
  return {json[kTime], kept_side(json, file.string())};
}

/// Whether a scene was measured with the same settings.
bool has_equal_settings(const MeasuredSide& one, const MeasuredSide& other, const std::string& of) {
  const auto a = one.settings.find(of), b = other.settings.find(of);
  return a != one.settings.end() && b != other.settings.end() && a->second == b->second;
}

/// The figure's mean over the seeds of a scene.
MeanInterval mean_of(const MeasuredSide& side,
                     const std::string& scene,
                     const std::string& figure) {
  std::vector<double> values;
  for (const MeasuredRun& run : side.runs) {
    const auto found = run.figures.find(figure);
    if (run.scene == scene && found != run.figures.end()) values.push_back(found->second);
  }
  return mean_interval(values);
}

/// The values that a limit allows at most and least, from the median of what was before.
std::vector<double> ends_of(const ChangeLimit& limit, double median) {
  const double sign = worse_of(limit.figure) == Worse::lower ? -1 : 1;
  switch (limit.allowed) {
    case Allowed::worse_by:
      return {median + sign * limit.most};
    case Allowed::changed_by:
      return {median - limit.most, median + limit.most};
    case Allowed::ratio:
      return {median * limit.most};
    case Allowed::equal:
      break;
  }
  return {median};
}

Chart chart_of(const std::vector<const HistoryRecord*>& records,
               const std::string& scene,
               const ChangeLimit& limit,
               double median) {
  const std::string unit = unit_of(limit.figure).name;
  Chart chart{.title = limit.figure,
              .x = {.label = "commit"},
              .y = {.label = limit.figure + (unit.empty() ? "" : " (" + unit + ")")}};
  Series values{.name = "mean over seeds", .mark = Mark::disc};
  for (const HistoryRecord* record : records) {
    constexpr std::size_t kShort = 7;
    const MeanInterval mean = mean_of(record->side, scene, limit.figure);
    values.add(static_cast<double>(chart.x.names.size()), mean.mean);
    values.notes.push_back(record->measured_at + ", " + record->side.cpu);
    chart.x.names.push_back(record->side.commit.substr(0, kShort));
  }
  chart.series.push_back(std::move(values));
  // Times of other hours are shown, and judged by no limit.
  if (!std::isfinite(median) || kind_of_figure(limit.figure) == FigureKind::time) return chart;
  for (const double end : ends_of(limit, median)) {
    chart.series.push_back({.name = chart.series.size() == 1 ? "limit" : "",
                            .x = {0, static_cast<double>(records.size() - 1)},
                            .y = {end, end},
                            .stroke = Stroke::dashed,
                            .colour = 1});
  }
  return chart;
}

}  // namespace

std::vector<HistoryRecord> read_history(const fs::path& folder) {
  std::vector<HistoryRecord> history;
  if (!fs::exists(folder)) return history;
  if (!fs::is_directory(folder)) {
    throw UserError("--history = " + folder.string() + ": is no folder");
  }
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".json") history.push_back(read_record(entry.path()));
  }
  std::ranges::sort(history, {}, &HistoryRecord::measured_at);
  return history;
}

std::vector<HistoryRecord> before(std::vector<HistoryRecord> history, const MeasuredSide& now) {
  std::erase_if(history, [&](const auto& record) { return record.side.commit == now.commit; });
  return history;
}

MeasuredSide median_side(const std::vector<HistoryRecord>& earlier, const MeasuredSide& now) {
  MeasuredSide median{.kept = true, .board = now.board};
  std::set<std::string> used;
  for (const MeasuredRun& run : now.runs) {
    std::map<std::string, std::vector<double>> values;
    for (const HistoryRecord& record : earlier) {
      if (!has_equal_settings(record.side, now, run.scene)) continue;
      for (const MeasuredRun& other : record.side.runs) {
        if (other.scene != run.scene || other.seed != run.seed) continue;
        used.insert(record.side.commit);
        median.gl_renderer = record.side.gl_renderer;
        median.cpu = record.side.cpu;
        for (const auto& [figure, value] : other.figures) values[figure].push_back(value);
      }
    }
    if (values.empty()) continue;
    RunFigures& middle = median.runs.emplace_back(MeasuredRun{run.scene, run.seed, {}}).figures;
    for (auto& [figure, all] : values) middle[figure] = quantile(std::move(all), 0.5);
    median.settings[run.scene] = now.settings.at(run.scene);
  }
  median.what = "median of " + std::to_string(used.size()) + " earlier commits";
  return median;
}

void write_record(const fs::path& folder, const HistoryRecord& record) {
  const std::string text = report_text({{"schema", kReportSchema},
                                        {"command", "compare"},
                                        {kTime, record.measured_at},
                                        {"new", json_of(record.side)}});
  // A commit's records of other scenes or settings stay beside it.
  const std::string settings = Json(record.side.settings).dump();
  char hash[sizeof "01234567"];
  std::snprintf(
      hash, sizeof hash, "%08x", hw::crc32c(std::as_bytes(std::span<const char>(settings))));
  const fs::path file = folder / (record.side.commit + "_" + hash + ".json");
  const fs::path partial = file.string() + ".partial";
  fs::create_directories(folder);
  fs::remove(partial);
  write_new_file(partial, text);
  fs::rename(partial, file);
}

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  char text[sizeof "2026-11-29T09:30:00Z"];
  return {text, std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc)};
}

std::vector<Figure> history_figures(const std::vector<HistoryRecord>& earlier,
                                    const MeasuredSide& median,
                                    const MeasuredSide& now,
                                    const std::vector<ChangeLimit>& limits) {
  const HistoryRecord newest{utc_now(), now};
  std::vector<Figure> figures;
  for (const auto& [scene, unused] : now.settings) {
    std::vector<const HistoryRecord*> records;
    for (const HistoryRecord& record : earlier) {
      if (has_equal_settings(record.side, now, scene)) records.push_back(&record);
    }
    records.push_back(&newest);
    Figure figure{.name = "history_" + std::to_string(figures.size() + 1),
                  .caption = scene + ": " + std::to_string(records.size()) +
                             " commits in the order of their measurement; dashed: where the limit "
                             "of the newest lies, from the median of those before it."};
    for (const ChangeLimit& limit : limits) {
      if (mean_of(now, scene, limit.figure).n == 0) continue;
      figure.panels.emplace_back(
          chart_of(records, scene, limit, mean_of(median, scene, limit.figure).mean));
    }
    figures.push_back(std::move(figure));
  }
  return figures;
}

}  // namespace wobblebench::bench
