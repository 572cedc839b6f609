#include "bench/studies/latency/latency_report.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/number_text.h"
#include "bench/output/report_parts.h"
#include "bench/results/times.h"
#include "bench/studies/latency/latency_spans_report.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kLeastShown_ms = 1;  // of the stages that a volume passes

/// What limits the stream.
std::string bottleneck_text(const LatencyStudy& study) {
  const Bottleneck bottleneck = bottleneck_of(study.summary);
  return "The bottleneck is **" + bottleneck.stage + "**, " +
         significant(bottleneck.times_the_next, 3) + " times the next.";
}

std::string predicted_text(const Drawn& of) {
  return "virtual time says " + fixed(of.median, 1) + " (" + fixed(of.low, 1) + " to " +
         fixed(of.high, 1) + ")";
}

/// How old the echoes of the scene's pictures are, and what its stages take.
KeyFigures answer_of(const LatencyStudy& study) {
  KeyFigures figures;
  if (study.checks.empty()) return figures;
  const LatencyCheck& scene = study.checks.front();
  const std::string age = " of the pictures are no later after a volume's last echo; ";
  figures
      .add("Newest echo, P50",
           scene.wall.p50,
           times::kP50.key,
           "50 %" + age + predicted_text(scene.predicted.p50_ms))
      .add("Newest echo, P99",
           scene.wall.p99,
           times::kP99.key,
           "99 %" + age + predicted_text(scene.predicted.p99_ms))
      .add("Volumes shown",
           scene.wall_volumes_per_s,
           times::kVolumesPerS.key,
           "Sound alone allows " + fixed(1e3 / scene.sound_ms, 2));
  for (const StageLoad& load : study.summary.loads) {
    if (load.ms_per_volume < kLeastShown_ms) continue;
    figures.add(load.stage + ", a volume",
                load.ms_per_volume,
                times::kVolume.key,
                "What this stage takes; stages work at the same time");
  }
  return figures;
}

std::string head_text(const LatencyStudy& study, const Provenance& provenance, const Scene& scene) {
  std::ostringstream text;
  const auto& acquisition = scene.acquisition;
  text << "Made by `wobblebench latency`. Commit " << provenance.commit << ", " << provenance.cpu
       << ", " << provenance.threads << " threads, " << provenance.gl_renderer
       << ". Scene: " << acquisition.frames_per_volume << " frames of "
       << acquisition.sticks_per_frame << " lines, " << fixed(acquisition.depth_m / kMillimetre, 0)
       << " mm; pictures of " << scene.render.ray_casting.image_size
       << "² pixels; simulated sticks, seed " << scene.simulation.seed
       << ", sent in real time; policy " << to_string(study.policy)
       << ". Wall clock: " << study.rounds << " streams of each setting, all settings in turn, of "
       << study.volumes << " volumes, the first two left out.";
  return text.str();
}

void add_spans(const LatencyStudy& study, Document& document) {
  document.add(Heading{"From the echo to the picture"})
      .add(Text{
          "The scene's first stream on the wall clock. Emission is as scheduled, of a volume's "
          "first and last stick. Until the interrupt by the model of the card, on the device's "
          "clock; from there on by the host's clock, on which the link's epoch lays the "
          "interrupt. From the last pass to ready: reading back."})
      .add(Figure{.name = "spans",
                  .caption = "The scene's first stream on the wall clock.",
                  .panels = {latency_spans_chart(study.summary.spans)}})
      .add(latency_spans_table(study.summary.spans));
}

Cell drawn_cell(const Drawn& of) {
  return Cell::spread(of.median, of.low, of.high);
}

Table check_table(const LatencyStudy& study) {
  using C = LatencyCheck;
  const auto wall = [](double Percentiles::*of) {
    return [of](const C& check) { return check.wall.*of; };
  };
  const auto drawn = [](Drawn Prediction::*of) {
    return [of](const C& check) { return drawn_cell(check.predicted.*of); };
  };
  const auto off_by = [](double Percentiles::*seen, Drawn Prediction::*said) {
    return [=](const C& of) { return 100 * ((of.predicted.*said).median / (of.wall.*seen) - 1); };
  };
  return table_of<C>(
      {.name = "settings"},
      study.checks,
      {{{"setting"}, &C::name},
       {{"calibrated_on", "times taken from it"}, &C::calibrated_on},
       {{"sound_ms", "sound", "ms", 1}, &C::sound_ms},
       {{"n"}, [](const C& of) { return of.wall.n; }},
       {{"p50_wall_ms", "P50 wall", "ms", 1}, wall(&Percentiles::p50)},
       {{"p50_virtual_ms", "P50 virtual", "ms", 1}, drawn(&Prediction::p50_ms)},
       {{"p50_off_percent", "off by", "%", 1}, off_by(&Percentiles::p50, &Prediction::p50_ms)},
       {{"p99_wall_ms", "P99 wall", "ms", 1}, wall(&Percentiles::p99)},
       {{"p99_virtual_ms", "P99 virtual", "ms", 1}, drawn(&Prediction::p99_ms)},
       {{"p99_off_percent", "off by", "%", 1}, off_by(&Percentiles::p99, &Prediction::p99_ms)},
       {{"volumes_per_s_wall", "volumes/s wall"}, &C::wall_volumes_per_s},
       {{"volumes_per_s_virtual", "volumes/s virtual"},
        [](const C& of) { return of.predicted.volumes_per_s; }},
       {{"rendering_wall_ms", "rendering a volume, wall", "ms", 1}, &C::wall_renderer_ms},
       {{"rendering_virtual_ms", "rendering a volume, virtual", "ms", 1},
        [](const C& of) { return of.predicted.renderer_ms; }}});
}

/// Side by side at each setting: what the wall clock showed, and virtual time with its interval.
Chart age_chart(const LatencyStudy& study,
                const std::string& percentile,
                double Percentiles::*wall,
                Drawn Prediction::*predicted) {
  constexpr double kApart = 0.1;
  Chart chart{.title = "Age of the newest echo, " + percentile,
              .x = {.label = "setting"},
              .y = {.label = percentile + " (ms)"}};
  Series on_wall{.name = "wall clock", .stroke = Stroke::none, .mark = Mark::square};
  Series in_virtual{.name = "virtual time", .stroke = Stroke::none, .mark = Mark::disc};
  for (const LatencyCheck& check : study.checks) {
    const auto at = static_cast<double>(chart.x.names.size());
    chart.x.names.push_back(check.name);
    on_wall.add(at - kApart, check.wall.*wall);
    const Drawn& drawn = check.predicted.*predicted;
    in_virtual.add(at + kApart, drawn.median);
    in_virtual.low.push_back(drawn.low);
    in_virtual.high.push_back(drawn.high);
  }
  chart.series = {std::move(on_wall), std::move(in_virtual)};
  return chart;
}

void add_checks(const LatencyStudy& study, Document& document) {
  Figure figure{.name = "ages",
                .caption =
                    "Age of the newest echo on both clocks; virtual time with what 95 % of "
                    "200 streams lie between."};
  figure.panels = {age_chart(study, "P50", &Percentiles::p50, &Prediction::p50_ms),
                   age_chart(study, "P99", &Percentiles::p99, &Prediction::p99_ms)};
  document.add(Heading{"Virtual time against the wall clock"})
      .add(Text{"Age of the newest echo, from its scheduled emission until the picture is ready. "
                "Service times are those of the settings that the table names, drawn in runs of 16 "
                "volumes; "
                "they depend on the number of frames linearly between them. Virtual: median of 200 "
                "streams as long as those on the wall, and in brackets what 95 % of them lie "
                "between: P99 of n pictures is one of their largest. Pass 1 of a shallower scan "
                "makes more pixels, which the model does not know: slices have as many over less "
                "depth."})
      .add(std::move(figure))
      .add(check_table(study));
}

Table stall_table(const LatencyStudy& study) {
  using S = StallRecovery;
  const auto or_none = [](double S::*of) {
    return [of](const S& s) { return std::isfinite(s.*of) ? Cell(s.*of) : Cell("none"); };
  };
  return table_of<S>(
      {.name = "stalls"},
      study.stalls,
      {{{"stall_ms", "stall", "ms", 0}, &S::stall_ms},
       {{"recovered_wall_ms", "recovered after, wall", "ms", 1}, or_none(&S::wall_ms)},
       {{"recovered_virtual_ms", "recovered after, virtual", "ms", 1}, or_none(&S::predicted_ms)},
       {{"worst_wall_ms", "oldest newest echo, wall", "ms", 1}, or_none(&S::wall_worst_ms)},
       {{"worst_virtual_ms", "oldest newest echo, virtual", "ms", 1},
        or_none(&S::predicted_worst_ms)}});
}

Chart stall_chart(const LatencyStudy& study,
                  const std::string& title,
                  double StallRecovery::*wall,
                  double StallRecovery::*predicted) {
  Chart chart{.title = title,
              .x = {.label = "stall (ms)", .scale = Scale::logarithmic},
              .y = {.label = "time (ms)", .low = 0}};
  Series on_wall{.name = "wall clock", .mark = Mark::square};
  Series in_virtual{.name = "virtual time", .stroke = Stroke::dashed, .mark = Mark::disc};
  for (const StallRecovery& stall : study.stalls) {
    chart.x.ticks.push_back(stall.stall_ms);
    on_wall.add(stall.stall_ms, stall.*wall);
    in_virtual.add(stall.stall_ms, stall.*predicted);
  }
  chart.series = {std::move(on_wall), std::move(in_virtual)};
  return chart;
}

void add_stalls(const LatencyStudy& study, Document& document) {
  Figure figure{.name = "stalls",
                .caption =
                    "Recovery from stalls on both clocks; a point that is missing had not "
                    "recovered before the stream's end."};
  figure.panels = {stall_chart(study,
                               "From the stall's end to recovery",
                               &StallRecovery::wall_ms,
                               &StallRecovery::predicted_ms),
                   stall_chart(study,
                               "Greatest age of the newest echo",
                               &StallRecovery::wall_worst_ms,
                               &StallRecovery::predicted_worst_ms)};
  document.add(Heading{"Recovery from stalls"})
      .add(Text{"The link sends nothing for so long, from the first stick of the middle volume on. "
                "Recovered: the first picture whose newest echo is no older than 90 % of those "
                "before the stall; the time counts from the stall's end."})
      .add(std::move(figure))
      .add(stall_table(study));
  const bool too_few = std::ranges::any_of(study.stalls, [](const StallRecovery& stall) {
    return !std::isfinite(stall.wall_ms) || !std::isfinite(stall.predicted_ms);
  });
  if (!too_few) return;
  document.add(Text{"**" + std::to_string(study.volumes) +
                    " volumes are too few** to see a recovery that is `none`: the stream ended "
                    "before it, " +
                    std::to_string(study.volumes - study.volumes / 2) +
                    " volumes after the stall; more `--volumes` would tell."});
}

Table crossover_table(const LatencyStudy& study) {
  constexpr double kDepths_mm[] = {60, 80, 120, 160, 240};
  Table table{.name = "crossovers", .columns = {{"times", "times of"}, {"lines"}}};
  for (const double depth : kDepths_mm) {
    table.columns.push_back({"frames_" + fixed(depth, 0) + "_mm", fixed(depth, 0) + " mm"});
  }
  for (const CrossoverCurve& curve : study.crossovers) {
    std::vector<Cell> row = {curve.times, curve.lines};
    for (std::size_t i = 0; i < curve.depth_mm.size(); ++i) {
      if (std::ranges::find(kDepths_mm, curve.depth_mm[i]) == std::end(kDepths_mm)) continue;
      const double frames = curve.frames[i];
      row.push_back(std::isfinite(frames) ? Cell(std::lround(std::ceil(frames))) : "never");
    }
    table.add(std::move(row));
  }
  return table;
}

/// For which depth and number of frames sound takes longer than rendering; the scene is a point.
/// Times of other machines are in the table alone, or lines would lie on each other.
Chart crossover_chart(const LatencyStudy& study, const Scene& scene) {
  Chart chart{.title = "Above its line sound takes longer than rendering, below it rendering does",
              .x = {.label = "depth (mm)"},
              .y = {.label = "frames a volume", .scale = Scale::logarithmic}};
  int colour = 0;
  for (const CrossoverCurve& curve : study.crossovers) {
    if (std::ranges::find(study.what_ifs, curve.times, &WhatIf::times) != study.what_ifs.end()) {
      continue;
    }
    chart.series.push_back({.name = curve.times + ", " + std::to_string(curve.lines) + " lines",
                            .x = curve.depth_mm,
                            .y = curve.frames,
                            .stroke = curve.times == "paper" ? Stroke::dashed : Stroke::solid,
                            .colour = colour++ % 3});
  }
  Series here{.name = "this scene", .stroke = Stroke::none, .mark = Mark::disc, .colour = 3};
  here.add(scene.acquisition.depth_m / kMillimetre, scene.acquisition.frames_per_volume);
  chart.series.push_back(std::move(here));
  return chart;
}

void add_crossovers(const LatencyStudy& study, const Scene& scene, Document& document) {
  document.add(Heading{"Where sound becomes the limit"})
      .add(Text{
          "The least number of frames a volume from which on the sound of a volume takes "
          "longer than its rendering (`2 d / c` a stick). Virtual time; paper: Table I, on its "
          "GPU. The scene has " +
          std::to_string(scene.acquisition.frames_per_volume) + " frames of " +
          std::to_string(scene.acquisition.sticks_per_frame) + " lines at " +
          fixed(scene.acquisition.depth_m / kMillimetre, 0) + " mm."})
      .add(crossover_table(study))
      .add(Figure{
          .name = "crossover",
          .caption = "For which depth and number of frames sound takes longer than rendering.",
          .panels = {crossover_chart(study, scene)}});
}

void add_what_ifs(const LatencyStudy& study, Document& document) {
  if (study.what_ifs.empty()) return;
  using W = WhatIf;
  Table table = table_of<W>(
      {.name = "what_ifs"},
      study.what_ifs,
      {{{"times", "times of"}, &W::times},
       {{"p50_ms", "P50", "ms", 1}, [](const W& of) { return drawn_cell(of.predicted.p50_ms); }},
       {{"p99_ms", "P99", "ms", 1}, [](const W& of) { return drawn_cell(of.predicted.p99_ms); }},
       {{"volumes_per_s", "volumes/s"}, [](const W& of) { return of.predicted.volumes_per_s; }},
       {{"rendering_ms", "rendering a volume", "ms", 1},
        [](const W& of) { return of.predicted.renderer_ms; }}});
  document.add(Heading{"The scene by other machines' times"})
      .add(Text{"Virtual time, as above, by service times of `--times`: a machine by the paper's "
                "settings of the renderer and by the default ones, whatever the scene's are. "
                "Waking up and writing, which are not known there, take no time."})
      .add(std::move(table));
}

void add_line_rates(const LatencyStudy& study, Document& document) {
  Table table = table_of<LineRate>({.name = "line_rates"},
                                   study.line_rates,
                                   {{{"first_loss", "first loss"}, &LineRate::loss},
                                    {{"per_s", "sticks a second", "", 0}, &LineRate::per_s}});
  document.add(Heading{"Highest line rate before the first loss"})
      .add(Text{"By bisection of the depth in virtual time, 300 volumes, 9 draws of service times: "
                "median (least to most). The scene sends " +
                fixed(study.scene_line_rate_per_s, 0) + " sticks a second."})
      .add(std::move(table));
}

}  // namespace

Document latency_document(const LatencyStudy& study,
                          const Provenance& provenance,
                          const Scene& scene) {
  Document document{.title = "Latency: acquisition against rendering", .name = "latency"};
  document.add(Text{bottleneck_text(study)}).add(answer_of(study));
  add_spans(study, document);
  add_checks(study, document);
  add_stalls(study, document);
  add_crossovers(study, scene, document);
  add_what_ifs(study, document);
  add_line_rates(study, document);
  document.add(Heading{"How it was measured"}).add(Text{head_text(study, provenance, scene)});
  return document;
}

Json latency_study_json(const LatencyStudy& study, const Document& document) {
  Json json = {{"clock", "wall and virtual"},
               {"volumes_each", study.volumes},
               {"rounds", study.rounds},
               {"line_rate_of_the_scene_per_s", study.scene_line_rate_per_s},
               {"bottleneck", bottleneck_of(study.summary).stage},
               {"times_the_next", number(bottleneck_of(study.summary).times_the_next)}};
  json.update(tables_json(document));
  return json;
}

}  // namespace wobblebench::bench
