#include <algorithm>
#include <nlohmann/json.hpp>

#include "bench/cli/board_report.h"
#include "bench/cli/simulation_report.h"
#include "bench/cli/stream_report.h"
#include "bench/output/report.h"
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
  Json loads = Json::array();
  for (const StageLoad& load : summary.loads) {
    loads.push_back({{"stage", load.stage}, {"ms_per_volume", load.ms_per_volume}});
  }
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
      {"loads", loads},
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
    const DepthStatistics& depth = error.depth;
    errors.push_back({{"volume", error.volume},
                      {"time_s", error.time_s},
                      {"depth_mm",
                       {{"bias", number(depth.bias_m / kMillimetre)},
                        {"median", number(depth.median_m / kMillimetre)},
                        {"rms", number(depth.rms_m / kMillimetre)},
                        {"p95", number(depth.p95_m / kMillimetre)},
                        {"n", depth.n}}},
                      {"missed_percent", number(error.missed_percent)},
                      {"false_percent", number(error.false_percent)}});
  }
  return errors;
}

/// Sets "effects" and "simulation".
void report_simulation(Json& json, const StreamReport& report, double sound_ms) {
  const auto& simulated = report.simulated;
  report_fidelity(json, simulated ? std::optional(simulated->fidelity) : std::nullopt);
  if (!simulated) return;
  const auto volumes =
      static_cast<double>(std::max<std::uint64_t>(report.result.reader.volumes, 1));
  const double volume_ms = simulated->volume_ms / volumes;
  json["simulation"].update({{"map_ms", simulated->map_ms},
                             {"once_ms", simulated->once_ms},
                             {"ms_per_volume", volume_ms},
                             {"times_real_time", number(sound_ms / volume_ms)},
                             {"late_ms", simulated->late_ms},
                             {"packets_dropped", simulated->packets_dropped}});
}

}  // namespace

std::string stream_report(const StreamReport& report,
                          Provenance provenance,
                          const ResolvedScene& scene,
                          const StepTimes& times) {
  Json json = report_head("stream", std::move(provenance), scene.options());
  json["acquisition"] = acquisition_json(scene.plan());
  report_simulation(json, report, to_milliseconds(scene.plan().volume_duration()));
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
  json["errors"] = errors_json(report);
  json["no_errors_because"] =
      report.why_no_errors.empty() ? Json(nullptr) : Json(report.why_no_errors);
  json["wall_ms"] = wall_json(times);
  return report_text(json);
}

}  // namespace wobblebench::bench
