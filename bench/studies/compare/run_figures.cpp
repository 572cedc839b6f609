#include "bench/studies/compare/run_figures.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/user_error.h"
#include "bench/evaluation/measures/picture_measures.h"
#include "bench/output/report_parts.h"
#include "bench/results/counts.h"
#include "bench/results/times.h"
#include "bench/scene/scene.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

/// Where report.json has figures of a run beside those of the picture.
constexpr std::pair<const Measure*, const char*> kPlaces[] = {
    {&times::kFrame, "/timing/render/frame_ms"},
    {&times::kSimulation, "/timing/simulation/ms_per_volume"},
    {&times::kRun, "/timing/wall_ms/total"},
    {&counts::kSticks, "/board/delivered"},
    {&counts::kSamples, "/board/samples/count"}};

void add(RunFigures& figures, const std::string& name, const Json& value) {
  if (value.is_number()) figures[name] = value.get<double>();
}

void add_at(RunFigures& figures,
            const std::string& name,
            const Json& in,
            const std::string& pointer) {
  const Json::json_pointer at(pointer);
  if (in.contains(at)) add(figures, name, in.at(at));
}

const Json& list_at(const Json& report, const char* pointer) {
  static const Json none = Json::array();
  const Json::json_pointer at(pointer);
  return report.contains(at) && report.at(at).is_array() ? report.at(at) : none;
}

/// A figure of each pass, and their sum under `all` unless that is empty.
void add_passes(RunFigures& figures,
                const Json& passes,
                const char* key,
                const std::string& ending,
                const std::string& all) {
  for (const Json& pass : passes) {
    if (!pass.contains(key) || !pass[key].is_number()) continue;
    const auto value = pass[key].get<double>();
    figures[pass.value("name", "") + ending] = value;
    if (!all.empty()) figures[all] += value;
  }
}

std::string text_at(const Json& report, const char* pointer) {
  const Json::json_pointer at(pointer);
  return report.contains(at) && report.at(at).is_string() ? report.at(at).get<std::string>() : "";
}

MeasuredRun run_of(const Json& report) {
  MeasuredRun run{.scene = text_at(report, "/scene/phantom/name"),
                  .figures = figures_of_run(report)};
  if (const Json::json_pointer at("/provenance/seed"); report.contains(at)) {
    const Json& seed = report.at(at);
    if (seed.is_number_unsigned()) run.seed = seed.get<std::uint64_t>();
  }
  return run;
}

MeasuredRun run_from(const Json& json) {
  MeasuredRun run{.scene = json.at("scene"), .seed = json.at("seed"), .figures = {}};
  for (const auto& [name, value] : json.at("figures").items()) add(run.figures, name, value);
  return run;
}

}  // namespace

FigureKind kind_of_figure(const std::string& name) {
  if (name.ends_with("_ms")) return FigureKind::time;
  const bool counted = name.ends_with(counts::kFetches.key) || name == counts::kSticks.key ||
                       name == counts::kSamples.key;
  return counted ? FigureKind::work : FigureKind::error;
}

const Measure* run_measure(const std::string& name) {
  std::vector<const Measure*> all = {&kPictureSsim, &times::kCpu, &counts::kFetches};
  for (const auto& [measure, place] : kPlaces) all.push_back(measure);
  all.insert(all.end(), picture_measures().begin(), picture_measures().end());
  const auto found = std::ranges::find(all, name, &Measure::key);
  return found == all.end() ? nullptr : *found;
}

Worse worse_of(const std::string& name) {
  const Measure* const measure = run_measure(name);
  return measure == nullptr ? Worse::higher : measure->worse;
}

const std::vector<std::string>& run_figure_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all = {times::kCpu.key, counts::kFetches.key, kPictureSsim.key};
    for (const Measure* measure : picture_measures()) all.emplace_back(measure->key);
    for (const auto& [measure, place] : kPlaces) all.emplace_back(measure->key);
    for (const char* pass : {"scan_conversion", "ray_casting", "shading", "smoothing"}) {
      all.push_back(std::string(pass) + "_ms");
      all.push_back(std::string(pass) + "_fetches");
    }
    return all;
  }();
  return names;
}

RunFigures figures_of_run(const Json& report) {
  RunFigures figures;
  for (const auto& [measure, place] : kPlaces) add_at(figures, measure->key, report, place);
  for (const Measure* measure : picture_measures()) {
    add_at(figures, measure->key, report, std::string("/error/") + measure->key);
  }
  add_at(figures, times::kCpu.key, report, "/provenance/load/own_cpu_s");
  if (const auto cpu = figures.find(times::kCpu.key); cpu != figures.end()) cpu->second *= 1e3;
  add_passes(figures, list_at(report, "/timing/render/passes"), "ms", "_ms", "");
  add_passes(figures,
             list_at(report, "/render/texture_fetches"),
             "fetches",
             "_fetches",
             counts::kFetches.key);
  return figures;
}

Json json_of(const MeasuredSide& side) {
  Json json = {{"what", side.what},
               {"commit", side.commit},
               {"cpu", side.cpu},
               {"gl_renderer", side.gl_renderer},
               {"kept", side.kept},
               {"board", side.board},
               {"settings", side.settings},
               {"runs", Json::array()}};
  for (const MeasuredRun& run : side.runs) {
    json["runs"].push_back({{"scene", run.scene}, {"seed", run.seed}, {"figures", run.figures}});
  }
  return json;
}

std::map<std::string, std::string> settings_in(const Json& report) {
  auto settings = values_by_key(report.value("scene", Json::object()));
  for (const char* key : {"simulation.seed", "simulation.threads"}) settings.erase(key);
  return settings;
}

MeasuredSide kept_side(const Json& report, const std::string& what) {
  const auto refuse = [&](const std::string& why) {
    throw UserError(what + ": report.json " + why);
  };
  MeasuredSide side{.what = what, .kept = true};
  try {
    const std::string command = report.is_object() ? report.value("command", "") : "";
    if (command != "run" && command != "compare") {
      refuse("must be of `run` or `compare`" +
             (command.empty() ? "" : ", not of `" + command + "`"));
    }
    if (report.value("schema", 0) != kReportSchema) {
      refuse("is of schema " + report.value("schema", Json()).dump() + "; must be " +
             std::to_string(kReportSchema) +
             ": make it with a program of this schema (CHANGELOG.md has the keys of both)");
    }
    if (command == "run") {
      side.commit = text_at(report, "/provenance/commit");
      side.cpu = text_at(report, "/provenance/cpu");
      side.gl_renderer = text_at(report, "/provenance/gl_renderer");
      side.runs.push_back(run_of(report));
      side.settings[side.runs.front().scene] = settings_in(report);
      return side;
    }
    const Json& kept = report.at("new");
    side.commit = kept.at("commit");
    side.cpu = kept.at("cpu");
    side.gl_renderer = kept.at("gl_renderer");
    side.board = kept.value("board", side.board);
    side.settings = kept.at("settings").get<decltype(side.settings)>();
    for (const Json& run : kept.at("runs")) side.runs.push_back(run_from(run));
  } catch (const Json::exception& error) {
    refuse(std::string("is damaged: ") + error.what());
  }
  return side;
}

}  // namespace wobblebench::bench
