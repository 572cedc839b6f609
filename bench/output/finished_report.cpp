#include "bench/output/finished_report.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "bench/output/report_parts.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;
using Paths = std::vector<std::string>;

/// In every report that has them.
const Paths kOfAll = {"/wall_ms",
                      "/cached",
                      "/simulation/map_ms",
                      "/simulation/once_ms",
                      "/simulation/ms_per_volume",
                      "/simulation/times_real_time",
                      "/simulation/late_ms",
                      "/simulation/packets_dropped"};

/// In the report of a command: measured times, what follows from them, and what depends on how far
/// a thread had come.
const std::map<std::string, Paths>& paths_by_command() {
  static const std::map<std::string, Paths> paths = {
      {"run",
       {"/render/passes",
        "/render/frame_ms",
        "/tolerance/predicted_render_ms",
        "/tolerance/render_ms",
        "/tolerance/measured",
        "/tolerance/kept"}},
      {"stream",
       {"/board/emitted",
        "/board/delivered",
        "/board/lost_ring_full",
        "/board/lost_link",
        "/board/lost_corrupt",
        "/board/lost_out_of_order",
        "/board/duplicates",
        "/stream/broke_off",
        "/latency",
        "/queues",
        "/send",
        "/video/seconds",
        "/errors",
        "/no_errors_because"}},
      {"rehearse",
       {"/rehearsal/wall_s", "/rehearsal/times_real_time", "/rehearsal/times_acquisition"}},
      {"board", {"/throughput/stages", "/cancel"}},
      {"tables", {"/reference", "/tables", "/arrival", "/stages", "/floor", "/fetches"}},
      {"accuracy", {"/accuracy/evaluation_ms", "/accuracy/render_ms"}},
      {"trade", {"/machines", "/trade/parts"}},
      {"tune",
       {"/tune/measured_points",
        "/tune/refused_points",
        "/tune/candidates",
        "/tune/chosen",
        "/tune/nearest",
        "/tune/at_an_end",
        "/tune/scenes",
        "/tune/reached",
        "/tune/reached_unseen",
        "/requests"}},
      {"rungs", {"/rungs"}},
      {"latency", {"/latency"}}};
  return paths;
}

void move(Json& report, const std::string& path) {
  const Json::json_pointer from(path);
  if (!report.contains(from)) return;
  report[Json::json_pointer("/timing" + path)] = report.at(from);
  report.at(from.parent_pointer()).erase(from.back());
}

}  // namespace

void move_to_timing(Json& report) {
  for (const std::string& path : kOfAll) move(report, path);
  const auto own = paths_by_command().find(report.at("command"));
  if (own == paths_by_command().end()) return;
  for (const std::string& path : own->second) move(report, path);
}

bool measures_times(const Json& report) {
  static const std::set<std::string> no_measurements = {"wall_ms", "cached", "board"};
  const Json timing = report.value("timing", Json::object());
  return std::any_of(timing.items().begin(), timing.items().end(), [](const auto& part) {
    return !no_measurements.contains(part.key());
  });
}

std::string finished_report(const std::string& report,
                            const std::vector<Check>& checks,
                            Progress& progress) {
  auto json = Json::parse(report);
  move_to_timing(json);
  if (!json.contains("checks")) json["checks"] = to_json(checks);
  json["warnings"] = progress.warnings();
  if (json.contains("timing")) {
    const MachineUse use = progress.machine_use();
    json["provenance"]["load"] = to_json(use);
    // Not among the report's warnings, which are those of every equal run.
    if (measures_times(json)) progress.warn(use.warning());
  }
  return report_text(json);
}

}  // namespace wobblebench::bench
