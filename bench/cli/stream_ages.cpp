#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "base/number_text.h"
#include "bench/cli/stream_report.h"

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

/// A line's fields.
class Line {
 public:
  explicit Line(hw::HostTime begin) : begin_(begin) {}

  void add(const std::string& field) { text_ += (text_.empty() ? "" : ",") + field; }
  void add_ms(double ms) { add(fixed(ms, 3)); }
  void add_time(const std::optional<hw::HostTime>& time) {
    add(time ? fixed(to_milliseconds(*time - begin_), 3) : "");
  }
  std::string end() && { return std::move(text_) + "\n"; }

 private:
  hw::HostTime begin_;
  std::string text_;
};

std::optional<hw::HostTime> arrival(const StickTimes& stick) {
  return stick.arrived ? std::optional(stick.received) : std::nullopt;
}

double age_ms(const StickTimes& stick, const PictureTimes& times, bool scheduled) {
  return to_milliseconds(times.ready - (scheduled ? *stick.fired : stick.acquired));
}

double pass_ms(const PictureTimes& times, const std::string& name) {
  double ms = 0;
  for (const render::PassTime& pass : times.passes) {
    if (pass.name == name) ms += pass.ms;
  }
  return ms;
}

}  // namespace

std::string stream_ages(const StreamReport& report) {
  const auto passes = pass_names(report.result);
  std::string csv =
      "volume,whole,sticks,lost_sticks,emitted_first_ms,emitted_last_ms,arrived_first_ms,"
      "arrived_last_ms,complete_ms,taken_ms,scan_conversion_ms";
  for (const std::string& pass : passes) csv += "," + pass + "_ms";
  csv += ",shown_ms,written_ms,age_oldest_ms,age_newest_ms\n";
  for (const PictureTimes& times : report.result.records) {
    Line line(report.result.begin);
    line.add(std::to_string(times.volume));
    line.add(times.whole ? "1" : "0");
    line.add(std::to_string(times.sticks));
    line.add(std::to_string(times.lost));
    for (const StickTimes& stick : {times.first, times.last}) line.add_time(stick.fired);
    for (const StickTimes& stick : {times.first, times.last}) line.add_time(arrival(stick));
    line.add_time(times.complete);
    line.add_time(times.taken);
    line.add_ms(times.update_ms);
    for (const std::string& pass : passes) line.add_ms(pass_ms(times, pass));
    line.add_time(times.ready);
    line.add_time(times.written);
    for (const StickTimes& stick : {times.first, times.last}) {
      line.add_ms(age_ms(stick, times, report.summary.scheduled));
    }
    csv += std::move(line).end();
  }
  return csv;
}

}  // namespace wobblebench::bench
