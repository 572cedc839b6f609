#include "bench/studies/latency/latency_spans_report.h"

#include <algorithm>
#include <iomanip>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "base/number_text.h"
#include "bench/output/report_parts.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

const char* clock_name(const LatencySpan& span) {
  return span.on_device_clock ? "device" : "host";
}

Json spans_json(const std::vector<LatencySpan>& spans) {
  Json json = Json::array();
  for (const LatencySpan& span : spans) {
    json.push_back({{"from", span.from},
                    {"to", span.to},
                    {"clock", clock_name(span)},
                    {"ms", span.ms ? percentiles_json(*span.ms) : Json(nullptr)}});
  }
  return json;
}

void add_rows(const std::string& echo, const std::vector<LatencySpan>& spans, Table& table) {
  for (const LatencySpan& span : spans) {
    std::vector<Cell> row = {echo, span.from, span.to, clock_name(span)};
    if (span.ms) {
      for (const double value : {span.ms->p50, span.ms->p99, span.ms->max}) row.emplace_back(value);
      row.emplace_back(span.ms->n);
    } else {
      row.insert(row.end(), {"not known", {}, {}, {}});
    }
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

Json percentiles_json(const Percentiles& of) {
  return {{"p50", number(of.p50)},
          {"p90", number(of.p90)},
          {"p99", number(of.p99)},
          {"p999", number(of.p999)},
          {"max", number(of.max)},
          {"n", of.n}};
}

std::string percentiles_text(const Percentiles& of) {
  if (of.n == 0) return "none";
  return fixed(of.p50, 1) + " | " + fixed(of.p90, 1) + " | " + fixed(of.p99, 1) + " | " +
         fixed(of.p999, 1) + " | " + fixed(of.max, 1) + " ms, n = " + std::to_string(of.n);
}

Json latency_spans_json(const LatencySpans& spans) {
  return {{"oldest_echo", spans_json(spans.oldest)},
          {"newest_echo", spans_json(spans.newest)},
          {"unknown_because", spans.why_unknown.empty() ? Json(nullptr) : Json(spans.why_unknown)}};
}

std::string latency_spans_text(const LatencySpans& spans) {
  std::ostringstream text;
  for (const LatencySpan& span : spans.newest) {
    text << "  " << std::left << std::setw(35) << (span.from + " to " + span.to)
         << (span.ms ? percentiles_text(*span.ms) : "not known")
         << (span.on_device_clock ? ", modelled, device's clock\n" : "\n");
  }
  if (!spans.why_unknown.empty()) text << "  not known: " << spans.why_unknown << "\n";
  return text.str();
}

Table latency_spans_table(const LatencySpans& spans) {
  Table table{.name = "spans",
              .columns = {{"echo"},
                          {"from"},
                          {"to"},
                          {"clock"},
                          {"p50_ms", "P50", "ms", 3},
                          {"p99_ms", "P99", "ms", 3},
                          {"max_ms", "max", "ms", 3},
                          {"n"}}};
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
