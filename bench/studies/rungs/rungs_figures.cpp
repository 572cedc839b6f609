#include <algorithm>
#include <cmath>

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

/// Each rung's time against its error against the rung above, one mark a body.
Figure draw_rungs(const RungsResults& results) {
  Chart chart{"The rungs: time and error against the rung above",
              {"first volume of a seed / time of its sound", Scale::logarithmic},
              {"RMS difference of the mean image (dB)", Scale::logarithmic}};
  std::vector<std::string> bodies;
  for (const RungError& error : results.errors) {
    if (std::find(bodies.begin(), bodies.end(), error.body) == bodies.end()) {
      bodies.push_back(error.body);
    }
  }
  const Mark marks[] = {Mark::disc, Mark::square, Mark::triangle, Mark::diamond};
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Series series{spaced(bodies[b]), {}, {}, Stroke::none, marks[b % 4], static_cast<int>(b)};
    for (const RungError& error : results.errors) {
      if (error.body != bodies[b] || !error.image_rms_db) continue;
      for (const RungTime& time : results.times) {
        if (time.rung != error.rung) continue;
        series.x.push_back(time.first_ms.median / results.sound_ms);
        series.y.push_back(*error.image_rms_db);
      }
    }
    chart.series.push_back(series);
  }
  for (const RungTime& time : results.times) {
    double highest = 0;
    for (const RungError& error : results.errors) {
      if (error.rung == time.rung && error.image_rms_db) {
        highest = std::max(highest, *error.image_rms_db);
      }
    }
    if (highest > 0) {
      chart.labels.push_back(
          {time.first_ms.median / results.sound_ms, highest, sim::to_string(time.rung)});
    }
  }
  return {"rungs",
          "Each rung's time for a volume of a new seed, as a share of the sound's, against how far "
          "its mean image lies from that of the rung above.",
          {chart}};
}

Figure draw_stages(const RungsResults& results) {
  BarChart chart{"Where the time of a moving volume goes", "share of CPU time (%)", {}, {}};
  std::vector<std::string> names;
  for (const StageTimes& stages : results.stages) {
    chart.rows.push_back(sim::to_string(stages.rung));
    for (const auto& [name, ms] : stages.stages) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  for (const std::string& name : names) {
    BarPart part{name, {}};
    for (const StageTimes& stages : results.stages) {
      double percent = 0;
      for (const auto& [stage, ms] : stages.stages) {
        if (stage == name) percent = 100 * ms / stages.total_ms();
      }
      part.values.push_back(percent);
    }
    chart.parts.push_back(part);
  }
  return {"stages", "CPU time of one volume on one thread, by stage.", {chart}};
}

Chart size_chart(const RungsResults& results, sim::Rung rung) {
  Chart chart{"Rung " + sim::to_string(rung),
              {"size / smallest", Scale::logarithmic},
              {"time of a moving volume (ms)", Scale::logarithmic}};
  const Mark marks[] = {Mark::disc, Mark::square, Mark::triangle, Mark::diamond};
  int number = 0;
  for (const std::string what : {"sticks", "frames", "samples", "scatterers"}) {
    Series series{what, {}, {}, Stroke::solid, marks[number], number};
    ++number;
    for (const GrowthPoint& point : results.growth) {
      if (point.what != what || point.rung != rung) continue;
      series.x.push_back(point.size);
      series.y.push_back(point.time.moving_ms.median);
    }
    if (series.x.empty()) continue;
    const double smallest = series.x.front();
    for (double& x : series.x) x /= smallest;
    chart.series.push_back(series);
  }
  return chart;
}

Figure draw_tissue(const RungsResults& results) {
  Chart chart{"Time against how much of the field is tissue",
              {"share of the samples (%)"},
              {"time of a moving volume (ms)"}};
  chart.y.low = 0.0;
  const Mark marks[] = {Mark::disc, Mark::square, Mark::triangle};
  for (const sim::Rung rung : volume_rungs()) {
    const int colour = rung_colour(rung);
    Series series{sim::to_string(rung), {}, {}, Stroke::solid, marks[colour], colour};
    for (const GrowthPoint& point : results.growth) {
      if (point.what != "tissue" || point.rung != rung) continue;
      series.x.push_back(100 * point.size);
      series.y.push_back(point.time.moving_ms.median);
    }
    chart.series.push_back(series);
  }
  return {"tissue", "From fluid alone to tissue alone.", {chart}};
}

}  // namespace

std::vector<Figure> rungs_figures(const RungsResults& results) {
  return {draw_rungs(results),
          draw_stages(results),
          {"growth",
           "How the time of a volume grows with its sizes; all but one stay the same.",
           {size_chart(results, sim::Rung::field), size_chart(results, sim::Rung::scatterers)}},
          draw_tissue(results)};
}

Image<glm::vec3> frames_picture(const RungsResults& results) {
  std::vector<Panel> frames;
  for (const RungFrame& frame : results.frames) {
    frames.push_back({frame.rung, grey(frame.picture)});
  }
  return draw_panels(frames, 300);
}

}  // namespace wobblebench::bench
