// The parts of an echo's age, as the reports of `stream` and `latency` give them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "bench/output/document/chart.h"
#include "bench/output/document/table.h"
#include "bench/pipeline/stream/stream_summary.h"

namespace wobblebench::bench {

void describe(const Percentiles& of, Measurements& to);
/// Times, ages and rates. NaN of a summary of nothing.
void describe(const StreamSummary& summary, Measurements& to);

/// All figures of Percentiles.
Chosen percentile_measures();

/// "oldest_echo" and "newest_echo": from, to, clock and times; null where the link does not tell.
nlohmann::ordered_json latency_spans_json(const LatencySpans& spans);
/// A table of both echoes.
Table latency_spans_table(const LatencySpans& spans);
/// A bar for each echo, of the medians of its spans: those of the card together, those from there
/// to the upload together, and each pass.
BarChart latency_spans_chart(const LatencySpans& spans);

}  // namespace wobblebench::bench
