#include <nlohmann/json.hpp>

#include "bench/output/report_parts.h"
#include "bench/studies/latency/latency_report.h"
#include "bench/studies/latency/latency_spans_report.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

Json ages_json(const Percentiles& of) {
  return {{"p50", number(of.p50)}, {"p99", number(of.p99)}, {"max", number(of.max)}, {"n", of.n}};
}

Json drawn_json(const Drawn& of) {
  return {{"median", number(of.median)}, {"low", number(of.low)}, {"high", number(of.high)}};
}

Json check_json(const LatencyCheck& check) {
  return {{"setting", check.name},
          {"calibrated_on", check.calibrated_on},
          {"sound_ms", check.sound_ms},
          {"age_newest_ms",
           {{"wall", ages_json(check.wall)},
            {"virtual",
             {{"p50", drawn_json(check.predicted_p50_ms)},
              {"p99", drawn_json(check.predicted_p99_ms)}}}}},
          {"volumes_per_s",
           {{"wall", number(check.wall_volumes_per_s)},
            {"virtual", number(check.predicted_volumes_per_s)}}},
          {"rendering_ms",
           {{"wall", number(check.wall_renderer_ms)},
            {"virtual", number(check.predicted_renderer_ms)}}}};
}

Json stall_json(const StallRecovery& stall) {
  return {{"stall_ms", stall.stall_ms},
          {"recovered_after_ms",
           {{"wall", number(stall.wall_ms)}, {"virtual", number(stall.predicted_ms)}}},
          {"worst_age_newest_ms",
           {{"wall", stall.wall_worst_ms}, {"virtual", stall.predicted_worst_ms}}}};
}

Json curve_json(const CrossoverCurve& curve) {
  Json points = Json::array();
  for (std::size_t i = 0; i < curve.frames.size(); ++i) {
    points.push_back({{"depth_mm", curve.depth_mm[i]}, {"frames", number(curve.frames[i])}});
  }
  return {{"times", curve.times}, {"lines", curve.lines}, {"points", points}};
}

template <class Items, class ToJson>
Json array_of(const Items& items, const ToJson& to_json) {
  Json array = Json::array();
  for (const auto& item : items) array.push_back(to_json(item));
  return array;
}

}  // namespace

Json latency_study_json(const LatencyStudy& study) {
  return {{"clock", "wall and virtual"},
          {"volumes_each", study.volumes},
          {"rounds", study.rounds},
          {"spans", latency_spans_json(study.summary.spans)},
          {"checks", array_of(study.checks, check_json)},
          {"stalls", array_of(study.stalls, stall_json)},
          {"crossovers", array_of(study.crossovers, curve_json)},
          {"line_rates",
           array_of(study.line_rates,
                    [](const LineRate& rate) {
                      return Json{{"first_loss", rate.loss},
                                  {"per_s",
                                   {{"median", rate.per_s.median},
                                    {"min", rate.per_s.min},
                                    {"max", rate.per_s.max}}}};
                    })},
          {"line_rate_of_the_scene_per_s", study.scene_line_rate_per_s},
          {"bottleneck", bottleneck_of(study.summary).stage},
          {"times_the_next", number(bottleneck_of(study.summary).times_the_next)}};
}

}  // namespace wobblebench::bench
