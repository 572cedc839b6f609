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
#include "bench/results/counts.h"
#include "bench/results/error.h"
#include "bench/studies/latency/latency_spans_report.h"

namespace wobblebench::bench {

namespace {

Json latency_json(const StreamReport& report) {
  const StreamSummary& summary = report.summary;
  const Bottleneck bottleneck = bottleneck_of(summary);
  Json json = {{"clock", "wall"}, {"ages_from", ages_from(summary)}};
  json.update(to_json(described(summary)));
  json.update(
      {{"spans", latency_spans_json(summary.spans)},
       {"loads", to_json(load_table(summary))},
       {"bottleneck", bottleneck.stage},
       {"times_the_next", number(bottleneck.times_the_next)},
       {"shown",
        {{"volumes", report.result.shown.volumes}, {"sticks", report.result.shown.sticks}}}});
  return json;
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

/// Standard deviation of the time between pictures; "none": there are fewer than two such times.
std::string deviation_text(const StreamSummary& summary) {
  return std::isfinite(summary.jitter_ms) ? fixed(summary.jitter_ms, 1) + " ms" : "none";
}

std::string rates_text(const StreamSummary& summary) {
  if (summary.interval.n == 0) return "rate        none: fewer than two pictures\n";
  return "rate        " + fixed(summary.volumes_per_s, 2) + " volumes/s, " +
         fixed(summary.pictures_per_s, 2) + " pictures/s over " + fixed(summary.seconds, 1) +
         " s; deviation of the time between pictures " + deviation_text(summary) + "\n";
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

void describe(const StreamResult& result, Measurements& to) {
  const auto superseded = [&](const std::string& before, const VolumeCount& count) {
    to.prefix("superseded_before_" + before);
    to.add(counts::kVolumes, count.volumes);
    to.add(counts::kSticks, count.sticks);
  };
  superseded("rendering", result.queue.superseded);
  superseded("writing", result.superseded_pictures);
  to.prefix("");
  to.add(counts::kLeft, result.left_sticks + result.queue.left_sticks + result.reader.left_sticks);
  to.add(counts::kNotTaken, result.account.delivered - result.reader.sticks);
  to.add(counts::kLeastFreeSlots, result.reader.least_free_slots);
  to.add(counts::kMostVolumes, result.queue.most_volumes);
  to.add(counts::kMeanVolumes, result.queue.mean_volumes);
  to.add(counts::kReaderBlocked, result.queue.blocked_ms);
}

std::string stream_report(const StreamReport& report,
                          Provenance provenance,
                          const ResolvedScene& scene,
                          const StepTimes& times) {
  Json json = report_head("stream", std::move(provenance), scene.options());
  json["acquisition"] = acquisition_json(scene.plan(), report.knows_times);
  json["acquisition"]["motor_angles"] = motor_json(report.result.reader.motor);
  report_simulation(json, report.simulated, scene.plan(), report.result.reader.volumes);
  json["board"] = account_json(report.result.account);
  json["board"]["link"] = link_json(report.result.link);
  json["stream"] = {
      {"policy", to_string(report.queue.policy)},
      {"queue", report.queue.volumes},
      {"broke_off", report.result.failure.empty() ? Json(nullptr) : Json(report.result.failure)}};
  json["latency"] = latency_json(report);
  json["queues"] = to_json(described(report.result));
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

std::string stream_headline(const StreamReport& report) {
  std::string text = sticks_text(report.result);
  if (!report.result.records.empty())
    text += rates_text(report.summary) + loads_text(report.summary);
  text += late_text(report) + errors_text(report);
  if (const auto& video = report.video) {
    text += "video       " + video->name + ": " + fixed(video->seconds, 1) + " s, " + video->codec +
            " by " + video->backend + "\n";
  }
  return text;
}

std::string stream_text(const StreamReport& report, const std::filesystem::path& folder) {
  std::string text = stream_headline(report);
  if (!report.result.records.empty()) {
    text += "\n" + markdown(percentile_table(report.summary)) + "\n" +
            markdown(latency_spans_table(report.summary.spans)) + "\n";
  }
  if (report.sent) text += send_text(*report.sent);
  return text + "written to  " + folder.string() + "\n";
}

}  // namespace wobblebench::bench
