#include "bench/studies/latency/latency_spans_report.h"

#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

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

std::string rows(const std::string& echo, const std::vector<LatencySpan>& spans) {
  std::ostringstream text;
  for (const LatencySpan& span : spans) {
    text << "| " << echo << " | " << span.from << " | " << span.to << " | " << clock_name(span)
         << " | ";
    if (span.ms) {
      text << fixed(span.ms->p50, 3) << " | " << fixed(span.ms->p99, 3) << " | "
           << fixed(span.ms->max, 3) << " | " << span.ms->n << " |\n";
    } else {
      text << "not known | | | |\n";
    }
  }
  return text.str();
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

std::string latency_spans_markdown(const LatencySpans& spans) {
  return "| echo | from | to | clock | P50, ms | P99, ms | max, ms | n |\n| --- | --- | --- | --- "
         "| ---: | ---: | ---: | ---: |\n" +
         rows("oldest", spans.oldest) + rows("newest", spans.newest);
}

}  // namespace wobblebench::bench
