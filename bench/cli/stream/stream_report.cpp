#include "bench/cli/stream/stream_report.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/number_text.h"
#include "base/statistics.h"
#include "base/units.h"
#include "bench/cli/board_report.h"
#include "bench/cli/stream/stream_page.h"
#include "bench/output/report.h"
#include "bench/pipeline/motor_warning.h"
#include "bench/results/error.h"
#include "bench/studies/latency/latency_spans_report.h"

namespace wobblebench::bench {

namespace {

/// Volumes and sticks that were not shown, by cause.
Json dropped_json(const StreamResult& result) {
  const auto of = [](const VolumeCount& count) {
    return Json{{"volumes", count.volumes}, {"sticks", count.sticks}};
  };
  return {{"superseded_before_rendering", of(result.queue.superseded)},
          {"superseded_before_writing", of(result.superseded_pictures)},
          {"left_at_the_end_sticks",
           result.left_sticks + result.queue.left_sticks + result.reader.left_sticks},
          {"not_taken_sticks", result.account.delivered - result.reader.sticks}};
}

Json latency_json(const StreamReport& report) {
  const StreamSummary& summary = report.summary;
  const Bottleneck bottleneck = bottleneck_of(summary);
  return {
      {"clock", "wall"},
      {"ages_from", summary.scheduled ? "scheduled emission" : "acquisition"},
      {"age_oldest_ms", percentiles_json(summary.age_oldest)},
      {"age_newest_ms", percentiles_json(summary.age_newest)},
      {"spans", latency_spans_json(summary.spans)},
      {"ready_to_written_ms", percentiles_json(summary.ready_to_written)},
      {"seconds", summary.seconds},
      {"volumes_per_s", summary.volumes_per_s},
      {"pictures_per_s", summary.pictures_per_s},
      {"interval_ms", percentiles_json(summary.interval)},
      {"jitter_ms", number(summary.jitter_ms)},
      {"loads", to_json(load_table(summary))},
      {"bottleneck", bottleneck.stage},
      {"times_the_next", number(bottleneck.times_the_next)},
      {"shown", {{"volumes", report.result.shown.volumes}, {"sticks", report.result.shown.sticks}}},
      {"dropped", dropped_json(report.result)}};
}

Json queues_json(const StreamResult& result) {
  return {{"ring", {{"least_free_slots", result.reader.least_free_slots}}},
          {"volumes",
           {{"most", result.queue.most_volumes},
            {"mean", result.queue.mean_volumes},
            {"reader_blocked_ms", result.queue.blocked_ms}}}};
}

/// Every volume that was measured, in time.
Json errors_json(const StreamReport& report) {
  Json errors = Json::array();
  for (const VolumeError& error : report.errors) {
    errors.push_back({{"volume", error.volume}, {"time_s", error.time_s}});
    errors.back().update(to_json(error.found));
  }
  return errors;
}

std::string rates_text(const StreamSummary& summary) {
  if (summary.interval.n == 0) return "rate        none: fewer than two pictures\n";
  return "rate        " + fixed(summary.volumes_per_s, 2) + " volumes/s, " +
         fixed(summary.pictures_per_s, 2) + " pictures/s over " + fixed(summary.seconds, 1) +
         " s; between pictures " + percentiles_text(summary.interval) + "; deviation " +
         deviation_text(summary) + "\n";
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
  const std::string text = "sticks      " + std::to_string(result.account.emitted) + " emitted, " +
                           std::to_string(result.account.delivered) + " delivered" +
                           losses_text(result.account);
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
    medians.push_back(error.found.value(error::kMedian));
    p95.push_back(error.found.value(error::kP95));
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

std::string stream_report(const StreamReport& report,
                          Provenance provenance,
                          const ResolvedScene& scene,
                          const StepTimes& times) {
  Json json = report_head("stream", std::move(provenance), scene.options());
  json["acquisition"] = acquisition_json(scene.plan());
  json["acquisition"]["motor_angles"] = motor_json(report.result.reader.motor);
  report_simulation(json, report.simulated, scene.plan(), report.result.reader.volumes);
  json["board"] = account_json(report.result.account);
  json["board"]["link"] = link_json(report.result.link);
  json["stream"] = {
      {"policy", to_string(report.queue.policy)},
      {"queue", report.queue.volumes},
      {"broke_off", report.result.failure.empty() ? Json(nullptr) : Json(report.result.failure)}};
  json["latency"] = latency_json(report);
  json["queues"] = queues_json(report.result);
  json["video"] = nullptr;
  if (const auto& video = report.video) {
    json["video"] = {{"file", video->name},
                     {"codec", video->codec},
                     {"encoder", video->backend},
                     {"seconds", video->seconds}};
  }
  json["send"] = report.sent ? send_json(*report.sent) : Json(nullptr);
  json["errors"] = errors_json(report);
  json["no_errors_because"] =
      report.why_no_errors.empty() ? Json(nullptr) : Json(report.why_no_errors);
  json["wall_ms"] = wall_json(times);
  return report_text(json);
}

std::string deviation_text(const StreamSummary& summary) {
  return std::isfinite(summary.jitter_ms) ? fixed(summary.jitter_ms, 1) + " ms" : "none";
}

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
  if (report.sent) text += send_text(*report.sent);
  return text + "written to  " + folder.string() + "\n";
}

}  // namespace wobblebench::bench
