#include "bench/studies/latency/latency_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/number_text.h"
#include "bench/output/report_parts.h"
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

namespace {

std::string ms(double value) {
  return std::isfinite(value) ? fixed(value, value < 10 ? 2 : 0) : "none";
}

std::string drawn(const Drawn& of) {
  return ms(of.median) + " (" + ms(of.low) + " to " + ms(of.high) + ")";
}

std::string off_by(double predicted, double wall) {
  return std::isfinite(predicted / wall) ? fixed(100 * (predicted / wall - 1), 1) + " %" : "none";
}

void write_head(const LatencyStudy& study,
                const Provenance& provenance,
                const Scene& scene,
                std::ostream& text) {
  const auto& acquisition = scene.acquisition;
  text << "# Latency: acquisition against rendering\n\nMade by `wobblebench latency`. Commit "
       << provenance.commit << ", " << provenance.cpu << ", " << provenance.threads << " threads, "
       << provenance.gl_renderer << ". Scene: " << acquisition.frames_per_volume << " frames of "
       << acquisition.sticks_per_frame << " lines, " << fixed(acquisition.depth_m / kMillimetre, 0)
       << " mm; pictures of " << scene.render.ray_casting.image_size
       << "² pixels; simulated sticks, seed " << scene.simulation.seed
       << ", sent in real time; policy " << to_string(study.policy)
       << ". Wall clock: " << study.rounds << " streams of each setting, all settings in turn, of "
       << study.volumes << " volumes, the first two left out.\n";
  const Bottleneck bottleneck = bottleneck_of(study.summary);
  text << "\nThe bottleneck of the scene is " << bottleneck.stage << ", "
       << significant(bottleneck.times_the_next, 3) << " times the next:";
  for (const StageLoad& load : study.summary.loads) {
    text << " " << load.stage << " " << ms(load.ms_per_volume) << " ms";
  }
  text << " a volume.\n";
}

void write_spans(const LatencyStudy& study, std::ostream& text) {
  text
      << "\n## From the echo to the picture\n\nThe scene's first stream on the wall clock. "
         "Emission is as scheduled, of a volume's first and last stick. Until the interrupt by the "
         "model of the card, on the device's clock; from there on by the host's clock, on which "
         "the link's epoch lays the interrupt. From the last pass to ready: reading back.\n\n"
      << latency_spans_markdown(study.summary.spans);
}

void write_checks(const LatencyStudy& study, std::ostream& text) {
  text << "\n## Virtual time against the wall clock\n\nAge of the newest echo, from its scheduled "
          "emission until the picture is ready. Service times are those of the settings marked "
          "with *, drawn in runs of 16 volumes; they depend on the number of frames linearly "
          "between them. Virtual: median of 200 streams as long as those on the wall, and in "
          "brackets what 95 % of them lie between: P99 of n pictures is one of their largest. Pass "
          "1 of a shallower scan makes more pixels, which the model does not know: slices have as "
          "many over less depth.\n\n"
          "| setting | sound, ms | n | P50 wall, ms | virtual | off by | P99 wall, ms | virtual | "
          "off by | volumes/s wall | virtual | rendering a volume, ms wall | virtual |\n"
          "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | "
          "---: |\n";
  for (const LatencyCheck& check : study.checks) {
    text << "| " << check.name << (check.calibrated_on ? " *" : "") << " | " << ms(check.sound_ms)
         << " | " << check.wall.n << " | " << ms(check.wall.p50) << " | "
         << drawn(check.predicted_p50_ms) << " | "
         << off_by(check.predicted_p50_ms.median, check.wall.p50) << " | " << ms(check.wall.p99)
         << " | " << drawn(check.predicted_p99_ms) << " | "
         << off_by(check.predicted_p99_ms.median, check.wall.p99) << " | "
         << fixed(check.wall_volumes_per_s, 2) << " | " << fixed(check.predicted_volumes_per_s, 2)
         << " | " << ms(check.wall_renderer_ms) << " | " << ms(check.predicted_renderer_ms)
         << " |\n";
  }
}

void write_stalls(const LatencyStudy& study, std::ostream& text) {
  text << "\n## Recovery from stalls\n\nThe link sends nothing for so long, from the first stick "
          "of the middle volume on. Recovered: the first picture whose newest echo is no older "
          "than 90 % of those before the stall; the time counts from the stall's end.\n\n"
          "| stall, ms | recovered after, wall, ms | virtual | oldest newest echo, wall, ms | "
          "virtual |\n| ---: | ---: | ---: | ---: | ---: |\n";
  for (const StallRecovery& stall : study.stalls) {
    text << "| " << ms(stall.stall_ms) << " | " << ms(stall.wall_ms) << " | "
         << ms(stall.predicted_ms) << " | " << ms(stall.wall_worst_ms) << " | "
         << ms(stall.predicted_worst_ms) << " |\n";
  }
}

void write_crossovers(const LatencyStudy& study, const Scene& scene, std::ostream& text) {
  text << "\n## Where sound becomes the limit\n\nThe least number of frames a volume from which on "
          "the sound of a volume takes longer than its rendering (`2 d / c` a stick). Virtual "
          "time; paper: Table I, on its GPU.\n\n| times of | lines |";
  const double depth_mm = scene.acquisition.depth_m / kMillimetre;
  const std::vector<double> depths = {60, 80, 120, 160, 240};
  for (const double depth : depths) text << " " << fixed(depth, 0) << " mm |";
  text << "\n| --- | ---: |";
  for (std::size_t i = 0; i < depths.size(); ++i) text << " ---: |";
  text << "\n";
  for (const CrossoverCurve& curve : study.crossovers) {
    text << "| " << curve.times << " | " << curve.lines << " |";
    for (std::size_t i = 0; i < curve.depth_mm.size(); ++i) {
      if (std::find(depths.begin(), depths.end(), curve.depth_mm[i]) == depths.end()) continue;
      const double frames = curve.frames[i];
      text << " " << (std::isfinite(frames) ? fixed(std::ceil(frames), 0) : "never") << " |";
    }
    text << "\n";
  }
  text << "\nThe scene has " << scene.acquisition.frames_per_volume << " frames of "
       << scene.acquisition.sticks_per_frame << " lines at " << fixed(depth_mm, 0)
       << " mm.\n\n[Chart: For "
       << "which depth and number of frames sound takes longer than rendering.]("
       << kCrossoverFigure << ")\n";
}

void write_line_rates(const LatencyStudy& study, std::ostream& text) {
  text << "\n## Highest line rate before the first loss\n\nBy bisection of the depth in virtual "
          "time, 300 volumes, 9 draws of service times: median (least to most). The scene sends "
       << fixed(study.scene_line_rate_per_s, 0) << " sticks a second.\n\n"
       << "| first loss | sticks a second |\n| --- | ---: |\n";
  for (const LineRate& rate : study.line_rates) {
    text << "| " << rate.loss << " | " << fixed(rate.per_s.median, 0) << " ("
         << fixed(rate.per_s.min, 0) << " to " << fixed(rate.per_s.max, 0) << ") |\n";
  }
}

}  // namespace

std::string latency_markdown(const LatencyStudy& study,
                             const Provenance& provenance,
                             const Scene& scene) {
  std::ostringstream text;
  write_head(study, provenance, scene, text);
  write_spans(study, text);
  write_checks(study, text);
  write_stalls(study, text);
  write_crossovers(study, scene, text);
  write_line_rates(study, text);
  return text.str();
}

Figure crossover_figure(const LatencyStudy& study, const Scene& scene) {
  Chart chart{"Above its line sound takes longer than rendering, below it rendering does",
              {"depth (mm)"},
              {"frames a volume", Scale::logarithmic}};
  int colour = 0;
  for (const CrossoverCurve& curve : study.crossovers) {
    const bool is_paper = curve.times == "paper";
    chart.series.push_back({curve.times + ", " + std::to_string(curve.lines) + " lines",
                            curve.depth_mm,
                            curve.frames,
                            is_paper ? Stroke::dashed : Stroke::solid,
                            Mark::none,
                            colour++ % 3});
  }
  chart.series.push_back({"this scene",
                          {scene.acquisition.depth_m / kMillimetre},
                          {static_cast<double>(scene.acquisition.frames_per_volume)},
                          Stroke::none,
                          Mark::disc,
                          3});
  return {"crossover",
          "For which depth and number of frames sound takes longer than rendering.",
          {chart}};
}

}  // namespace wobblebench::bench
