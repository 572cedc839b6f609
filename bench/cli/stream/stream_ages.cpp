#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "base/duration.h"
#include "bench/cli/stream/stream_page.h"

namespace wobblebench::bench {

namespace {

constexpr const char* kPassOne = "scan_conversion";

/// Names of passes 2 to 4 in the order in which they come first.
std::vector<std::string> pass_names(const StreamResult& result) {
  std::vector<std::string> names;
  for (const PictureTimes& times : result.records) {
    for (const render::PassTime& pass : times.passes) {
      if (pass.name == kPassOne || std::ranges::find(names, pass.name) != names.end()) continue;
      names.push_back(pass.name);
    }
  }
  return names;
}

double pass_ms(const PictureTimes& times, const std::string& name) {
  double ms = 0;
  for (const render::PassTime& pass : times.passes) {
    if (pass.name == name) ms += pass.ms;
  }
  return ms;
}

std::vector<Column> columns_of(const std::vector<std::string>& passes) {
  std::vector<Column> columns = {{"volume"}, {"whole"}, {"sticks"}, {"lost_sticks"}};
  for (const char* key : {"emitted_first_ms",
                          "emitted_last_ms",
                          "arrived_first_ms",
                          "arrived_last_ms",
                          "complete_ms",
                          "taken_ms",
                          "scan_conversion_ms"}) {
    columns.push_back({key});
  }
  for (const std::string& pass : passes) columns.push_back({pass + "_ms"});
  for (const char* key : {"shown_ms", "written_ms", "age_oldest_ms", "age_newest_ms"}) {
    columns.push_back({key});
  }
  return columns;
}

}  // namespace

double age_ms(const StickTimes& stick, const PictureTimes& times, bool scheduled) {
  return to_milliseconds(times.ready - (scheduled ? *stick.fired : stick.acquired));
}

Table stream_ages(const StreamReport& report) {
  const auto passes = pass_names(report.result);
  const auto since = [&](hw::HostTime time) {
    return Cell(to_milliseconds(time - report.result.begin));
  };
  Table table{.name = "ages", .columns = columns_of(passes)};
  for (const PictureTimes& times : report.result.records) {
    std::vector<Cell> row = {times.volume, times.whole ? 1 : 0, times.sticks, times.lost};
    for (const StickTimes& stick : {times.first, times.last}) {
      row.push_back(stick.fired ? since(*stick.fired) : Cell());
    }
    for (const StickTimes& stick : {times.first, times.last}) {
      row.push_back(stick.arrived ? since(stick.received) : Cell());
    }
    row.insert(row.end(), {since(times.complete), since(times.taken), times.update_ms});
    for (const std::string& pass : passes) row.emplace_back(pass_ms(times, pass));
    row.insert(row.end(), {since(times.ready), since(times.written)});
    for (const StickTimes& stick : {times.first, times.last}) {
      row.emplace_back(age_ms(stick, times, report.summary.scheduled));
    }
    table.add(std::move(row));
  }
  return table;
}

}  // namespace wobblebench::bench
