#include <cmath>

#include "base/number_text.h"
#include "base/statistics.h"
#include "base/units.h"
#include "bench/cli/board_report.h"
#include "bench/cli/stream_report.h"
#include "bench/studies/latency/latency_spans_report.h"

namespace wobblebench::bench {

namespace {

std::string rates_text(const StreamSummary& summary) {
  if (summary.interval.n == 0) return "rate        none: fewer than two pictures\n";
  return "rate        " + fixed(summary.volumes_per_s, 2) + " volumes/s, " +
         fixed(summary.pictures_per_s, 2) + " pictures/s over " + fixed(summary.seconds, 1) +
         " s; between pictures " + percentiles_text(summary.interval) + "; deviation " +
         fixed(summary.jitter_ms, 1) + " ms\n";
}

std::string ages_text(const StreamSummary& summary) {
  const std::string from = summary.scheduled ? "scheduled emission" : "acquisition";
  std::string text = "            P50 | P90 | P99 | P99.9 | max, wall clock, from " + from + "\n";
  text += "oldest echo " + percentiles_text(summary.age_oldest) + "\n";
  text += "newest echo " + percentiles_text(summary.age_newest) + "\n";
  text += latency_spans_text(summary.spans);
  return text + "  ready to written                   " +
         percentiles_text(summary.ready_to_written) + "\n";
}

std::string loads_text(const StreamSummary& summary) {
  const Bottleneck bottleneck = bottleneck_of(summary);
  std::string text = "bottleneck  " + bottleneck.stage;
  if (std::isfinite(bottleneck.times_the_next)) {
    text += ", " + significant(bottleneck.times_the_next, 3) + " times the next";
  }
  text += ": ms a volume";
  for (const StageLoad& load : summary.loads) {
    text += ", " + load.stage + " " + fixed(load.ms_per_volume, 1);
  }
  return text + "\n";
}

std::string sticks_text(const StreamResult& result) {
  std::string text = "sticks      " + std::to_string(result.account.emitted) + " emitted, " +
                     std::to_string(result.account.delivered) + " delivered";
  for (const auto& [cause, count] : losses_by_cause(result.account)) {
    if (count != 0) text += ", " + std::to_string(count) + " lost: " + cause;
  }
  const auto volumes = [](const VolumeCount& count) { return std::to_string(count.volumes); };
  return text + "\nvolumes     " + volumes(result.shown) + " shown, " +
         volumes(result.queue.superseded) + " superseded before rendering, " +
         volumes(result.superseded_pictures) + " before writing\n";
}

/// A simulator that does not keep up delays its probe: ages hold nothing of that.
std::string late_text(const StreamReport& report) {
  if (!report.simulated || report.simulated->late_ms <= 0) return "";
  return "simulator   was late by " + fixed(report.simulated->late_ms, 0) +
         " ms in all, for which the probe waited; `record`, then `--board "
         "file=…,pace=realtime`, is in time\n";
}

std::string errors_text(const StreamReport& report) {
  if (report.errors.empty()) return "depth error none: " + report.why_no_errors + "\n";
  std::vector<double> medians, p95;
  for (const VolumeError& error : report.errors) {
    medians.push_back(error.depth.median_m / kMillimetre);
    p95.push_back(error.depth.p95_m / kMillimetre);
  }
  const auto range = [](const std::vector<double>& values) {
    const Spread spread = spread_of(values);
    return significant(spread.median, 3) + " (" + significant(spread.min, 3) + " to " +
           significant(spread.max, 3) + ") mm";
  };
  return "depth error of " + std::to_string(report.errors.size()) +
         " volumes, each at its own time: median " + range(medians) + ", P95 " + range(p95) + "\n";
}

}  // namespace

std::string stream_text(const StreamReport& report, const std::filesystem::path& folder) {
  std::string text = sticks_text(report.result);
  if (!report.result.records.empty()) {
    text += rates_text(report.summary) + ages_text(report.summary) + loads_text(report.summary);
  }
  text += late_text(report) + errors_text(report);
  if (const auto& video = report.video) {
    text += "video       " + video->name + ": " + fixed(video->seconds, 1) + " s, " + video->codec +
            " by " + video->backend + "\n";
  }
  return text + "written to  " + folder.string() + "\n";
}

}  // namespace wobblebench::bench
