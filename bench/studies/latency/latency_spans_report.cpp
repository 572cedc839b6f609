#include "bench/studies/latency/latency_spans_report.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "bench/results/times.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

constexpr const Measure* kOfSpans[] = {&times::kP50, &times::kP99, &times::kMax, &times::kN};

const char* clock_name(const LatencySpan& span) {
  return span.on_device_clock ? "device" : "host";
}

Json spans_json(const std::vector<LatencySpan>& spans) {
  Json json = Json::array();
  for (const LatencySpan& span : spans) {
    json.push_back(Json{{"from", span.from}, {"to", span.to}, {"clock", clock_name(span)}});
    json.back().update(to_json(described(span.ms.value_or(percentiles_of({})))));
  }
  return json;
}

void add_rows(const std::string& echo, const std::vector<LatencySpan>& spans, Table& table) {
  for (const LatencySpan& span : spans) {
    std::vector<Cell> row = {echo, span.from, span.to, clock_name(span)};
    if (span.ms) row = cells_of(std::move(row), described(*span.ms), kOfSpans);
    if (!span.ms) row.emplace_back("not known");
    row.resize(table.columns.size());
    table.add(std::move(row));
  }
}

std::string part_name(const LatencySpan& span, bool uploaded) {
  if (span.on_device_clock) return "card (modelled)";
  if (!uploaded) return "board, queue and upload";
  return span.to == "ready" ? "reading back" : span.to;
}

BarPart& part_of(BarChart& chart, const std::string& name) {
  for (BarPart& part : chart.parts) {
    if (part.name == name) return part;
  }
  chart.parts.push_back({name, std::vector<double>(chart.rows.size(), 0)});
  return chart.parts.back();
}

}  // namespace

void describe(const Percentiles& of, Measurements& to) {
  to.add(times::kP50, of.p50);
  to.add(times::kP90, of.p90);
  to.add(times::kP99, of.p99);
  to.add(times::kP999, of.p999);
  to.add(times::kMax, of.max);
  to.add(times::kN, of.n);
}

void describe(const StreamSummary& summary, Measurements& to) {
  const auto add = [&](const std::string& name, const Percentiles& of) {
    to.prefix(name);
    describe(of, to);
  };
  add("age_oldest", summary.age_oldest);
  add("age_newest", summary.age_newest);
  add("ready_to_written", summary.ready_to_written);
  to.prefix("");
  to.add(times::kSeconds, summary.seconds);
  to.add(times::kVolumesPerS, summary.volumes_per_s);
  to.add(times::kPicturesPerS, summary.pictures_per_s);
  add("interval", summary.interval);
  to.prefix("");
  to.add(times::kJitter, summary.jitter_ms);
  const auto renderer = std::ranges::find(summary.loads, "renderer", &StageLoad::stage);
  const bool known = renderer != summary.loads.end();
  to.add(times::kFrame, known ? renderer->ms_per_volume : std::nan(""));
}

Chosen percentile_measures() {
  static constexpr const Measure* kAll[] = {
      &times::kP50, &times::kP90, &times::kP99, &times::kP999, &times::kMax, &times::kN};
  return kAll;
}

Json latency_spans_json(const LatencySpans& spans) {
  return {{"oldest_echo", spans_json(spans.oldest)},
          {"newest_echo", spans_json(spans.newest)},
          {"unknown_because", spans.why_unknown.empty() ? Json(nullptr) : Json(spans.why_unknown)}};
}

Table latency_spans_table(const LatencySpans& spans) {
  const std::string& why = spans.why_unknown;
  Table table{.name = "spans",
              .caption = "The ages as spans that follow each other" +
                         (why.empty() ? "" : "; not known: " + why),
              .columns = columns_of({{"echo"}, {"from"}, {"to"}, {"clock"}}, kOfSpans)};
  for (Column& column : table.columns) column.digits = 3;
  add_rows("oldest", spans.oldest, table);
  add_rows("newest", spans.newest, table);
  return table;
}

BarChart latency_spans_chart(const LatencySpans& spans) {
  BarChart chart{.title = "From the echo to the picture",
                 .label = "time (ms): medians of the spans, added",
                 .rows = {"oldest echo", "newest echo"}};
  const std::vector<LatencySpan>* echoes[] = {&spans.oldest, &spans.newest};
  for (std::size_t row = 0; row < std::size(echoes); ++row) {
    bool uploaded = false;
    for (const LatencySpan& span : *echoes[row]) {
      BarPart& part = part_of(chart, part_name(span, uploaded));
      if (span.ms) part.values[row] += std::max(0.0, span.ms->p50);
      uploaded = uploaded || span.to == "uploaded";
    }
  }
  return chart;
}

}  // namespace wobblebench::bench
