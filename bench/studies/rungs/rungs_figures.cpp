#include <algorithm>
#include <cmath>

#include "base/number_text.h"
#include "bench/output/picture/panels.h"
#include "bench/studies/rungs/rungs_report.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

int rung_colour(sim::Rung rung) {
  const auto& rungs = volume_rungs();
  return static_cast<int>(std::find(rungs.begin(), rungs.end(), rung) - rungs.begin());
}

std::string spaced(std::string text) {
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

constexpr Mark kMarks[] = {Mark::disc, Mark::square, Mark::triangle, Mark::diamond};

std::vector<std::string> bodies_of(const RungsResults& results) {
  std::vector<std::string> bodies;
  for (const RungError& error : results.errors) {
    if (std::find(bodies.begin(), bodies.end(), error.body) == bodies.end()) {
      bodies.push_back(error.body);
    }
  }
  return bodies;
}

std::string ms_text(const Spread& ms) {
  return fixed(ms.median, 0) + " ms (" + fixed(ms.min, 0) + " to " + fixed(ms.max, 0) + ")";
}

/// A point with the least and the greatest time.
void add_time(double x, const Spread& ms, double unit_ms, Series& series) {
  series.add(x, ms.median / unit_ms);
  series.low.push_back(ms.min / unit_ms);
  series.high.push_back(ms.max / unit_ms);
}

/// One mark for each rung, one colour for each body.
Series rung_series(const RungsResults& results, const RungTime& time, const RungError& error) {
  const auto bodies = bodies_of(results);
  const auto body = std::find(bodies.begin(), bodies.end(), error.body) - bodies.begin();
  const std::string name = spaced(error.body) + ", " + sim::to_string(error.rung);
  Series series{.name = name,
                .stroke = Stroke::none,
                .mark = kMarks[rung_colour(error.rung) % 4],
                .colour = static_cast<int>(body)};
  add_time(error.image_rms_db.value(), time.first_ms, results.sound_ms, series);
  series.notes.push_back(name + ": " + ms_text(time.first_ms));
  return series;
}

Chart size_chart(const RungsResults& results, sim::Rung rung) {
  Chart chart{"Rung " + sim::to_string(rung),
              {"size / smallest", Scale::logarithmic},
              {"time of a moving volume (ms)", Scale::logarithmic}};
  int number = 0;
  for (const std::string what : {"sticks", "frames", "samples", "scatterers"}) {
    Series series{.name = what, .mark = kMarks[number], .colour = number};
    ++number;
    for (const GrowthPoint& point : results.growth) {
      if (point.what != what || point.rung != rung) continue;
      add_time(point.size, point.time.moving_ms, 1, series);
    }
    if (series.x.empty()) continue;
    const double smallest = series.x.front();
    for (double& x : series.x) x /= smallest;
    chart.series.push_back(series);
  }
  return chart;
}

}  // namespace

Figure rungs_figure(const RungsResults& results) {
  Chart chart{
      .title = "The rungs: time and error against the rung above",
      .x = {.label = "RMS difference of the mean image (dB)", .scale = Scale::logarithmic},
      .y = {.label = "first volume of a seed / time of its sound", .scale = Scale::logarithmic}};
  for (const RungTime& time : results.times) {
    for (const RungError& error : results.errors) {
      if (error.rung != time.rung || !error.image_rms_db) continue;
      chart.series.push_back(rung_series(results, time, error));
    }
  }
  return {"rungs",
          "Each rung's time for a volume of a new seed of " + spaced(results.phantom) +
              ", as a share of the sound's, against how far its mean image of each body lies from "
              "that of the rung above.",
          {chart}};
}

Figure growth_figure(const RungsResults& results) {
  return {"growth",
          "How the time of a volume grows with its sizes; all but one stay the same.",
          {size_chart(results, sim::Rung::field), size_chart(results, sim::Rung::scatterers)}};
}

Figure tissue_figure(const RungsResults& results) {
  Chart chart{"Time against how much of the field is tissue",
              {"share of the samples (%)"},
              {"time of a moving volume (ms)"}};
  chart.y.low = 0.0;
  for (const sim::Rung rung : volume_rungs()) {
    const int number = rung_colour(rung);
    Series series{.name = sim::to_string(rung), .mark = kMarks[number], .colour = number};
    for (const GrowthPoint& point : results.growth) {
      if (point.what != "tissue" || point.rung != rung) continue;
      add_time(100 * point.size, point.time.moving_ms, 1, series);
    }
    chart.series.push_back(series);
  }
  return {"tissue", "From fluid alone to tissue alone.", {chart}};
}

Image<glm::vec3> frames_picture(const RungsResults& results) {
  std::vector<Panel> frames;
  for (const RungFrame& frame : results.frames) {
    frames.push_back({frame.rung, grey(frame.picture)});
  }
  return draw_panels(frames, 300);
}

}  // namespace wobblebench::bench
