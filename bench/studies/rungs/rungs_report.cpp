#include "bench/studies/rungs/rungs_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/number_text.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

std::string spread_text(const Spread& ms, int digits = 0) {
  return fixed(ms.median, digits) + " (" + fixed(ms.min, digits) + " to " + fixed(ms.max, digits) +
         ")";
}

/// Duration of the acquisition over that of its simulation.
std::string times_real_time(double ms, double acquisition_ms) {
  const double times = acquisition_ms / ms;
  return fixed(times, times < 9.95 ? 1 : 0);
}

const RungTime* time_of(const RungsResults& results, sim::Rung rung) {
  for (const RungTime& time : results.times) {
    if (time.rung == rung) return &time;
  }
  return nullptr;
}

/// Estimated lower bound of the time of a volume on two AVX2 cores: 10 ms for the 1.21 million
/// samples of `field`, 0.2 s for 47 million scatterers. 0: no estimate.
double floor_ms(sim::Rung rung, const RungsResults& results) {
  constexpr double kFieldFloor_ms = 10, kFieldSamples = 1.21e6;
  constexpr double kScattererFloor_ms = 200, kScatterers = 47e6;
  if (rung == sim::Rung::field) return kFieldFloor_ms * results.samples / kFieldSamples;
  for (const StageTimes& stages : results.stages) {
    if (stages.rung != rung || stages.scatterers == 0) continue;
    return kScattererFloor_ms * static_cast<double>(stages.scatterers) / kScatterers;
  }
  return 0;
}

void write_head(const RungsResults& results, const Provenance& provenance, std::ostream& markdown) {
  markdown
      << "# Trade of the simulator's rungs\n\n"
      << "Made by `wobblebench rungs`. Commit " << provenance.commit << ", " << provenance.cpu
      << ", " << provenance.threads << " threads. Phantom " << results.phantom
      << "; a volume's sound takes " << fixed(results.sound_ms, 1) << " ms"
      << ". Seeds " << results.seeds.front() << " to " << results.seeds.back()
      << ". Times are wall times of all threads, median (least to most) of " << results.repeats
      << " after one uncounted, the rungs in turn in each repeat. All rows are in `rungs.csv`.\n";
}

void write_rungs(const RungsResults& results, std::ostream& markdown) {
  markdown
      << "\n## Time and error\n\n"
         "Error against the truth: where a stick first shows tissue (mean of three samples above "
         "0.3 of the display) less where it meets the surface. Error against the rung above: the "
         "same between the two, and the difference of what is displayed, averaged over the seeds, "
         "where either shows anything.\n\n"
         "| body | rung | first volume, ms | times real time | surface against truth: median, P95, "
         "mm; missed | surface against the rung above: median, P95, mm | image against the rung "
         "above: RMS, dB; correlation |\n| --- | --- | ---: | ---: | ---: | ---: | ---: |\n";
  for (const RungError& error : results.errors) {
    const RungTime* time = time_of(results, error.rung);
    const bool timed = time != nullptr && error.body == results.phantom;
    markdown << "| " << error.body << " | " << sim::to_string(error.rung) << " | "
             << (timed ? fixed(time->first_ms.median, 0) : "") << " | "
             << (timed ? times_real_time(time->first_ms.median, results.sound_ms) : "") << " | "
             << fixed(error.against_truth.median_mm, 2) << ", "
             << fixed(error.against_truth.p95_abs_mm, 2) << "; "
             << fixed(error.against_truth.missed_percent, 1) << " % | "
             << (error.against_above ? fixed(error.against_above->median_abs_mm, 2) + ", " +
                                           fixed(error.against_above->p95_abs_mm, 2)
                                     : "none above")
             << " | "
             << (error.image_rms_db
                     ? fixed(*error.image_rms_db, 2) + "; " + fixed(*error.image_correlation, 4)
                     : "none above")
             << " |\n";
  }
  const Spread& reference = results.small_reference.first_ms;
  const Spread& scatterers = results.small_scatterers.first_ms;
  markdown << "\n`reference` sums over the probe's elements and is for small scenes: on the sheet "
              "above (4 sticks) a volume takes "
           << spread_text(reference) << " ms, against " << spread_text(scatterers, 1)
           << " ms by `scatterers`, " << fixed(reference.median / scatterers.median, 0)
           << " times as long (" << kSmallRepeats << " repeats).\n";
}

void write_times(const RungsResults& results, std::ostream& markdown) {
  markdown
      << "\n## Time of a volume\n\n"
         "Map: the phantom's surfaces brought onto one lattice, once for a phantom. Once for a "
         "seed: tables, homogeneous speckle and, as nothing moves, all echoes. Still: a further "
         "volume, its noise and receive chain. Moving: of "
      << kVolumesInARow
      << " volumes in a row of the phantom on a path, each; bending: and its head turning. Behind "
         "a slash: times real time.\n\n"
         "| rung | map, ms | once for a seed, ms | first volume, ms | further still volume, ms | "
         "moving, ms | bending, ms |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: |\n";
  for (const RungTime& time : results.times) {
    const auto cell = [&](const Spread& ms) {
      return spread_text(ms) + " / " + times_real_time(ms.median, results.sound_ms);
    };
    markdown << "| " << sim::to_string(time.rung) << " | " << spread_text(time.map_ms) << " | "
             << spread_text(time.once_ms) << " | " << cell(time.first_ms) << " | "
             << cell(time.still_ms) << " | " << cell(time.moving_ms) << " | "
             << cell(time.bending_ms) << " |\n";
  }
  markdown << "\nThe floor is the design's estimate for two AVX2 cores: 10 ms for the 1.21 million "
              "samples of a volume of `field` (50 multiplications and additions a sample, "
              "look-ups, hashes), 0.2 s for 47 million scatterers' echoes.\n\n"
              "| rung | floor, ms | moving volume over floor | first volume over floor |\n"
              "| --- | ---: | ---: | ---: |\n";
  for (const RungTime& time : results.times) {
    const double floor = floor_ms(time.rung, results);
    if (floor == 0) continue;
    markdown << "| " << sim::to_string(time.rung) << " | " << fixed(floor, 0) << " | "
             << fixed(time.moving_ms.median / floor, 1) << " | "
             << fixed(time.first_ms.median / floor, 1) << " |\n";
  }
}

void write_stages(const RungsResults& results, std::ostream& markdown) {
  markdown << "\n## Where the time goes\n\n"
              "CPU time of a moving volume on one thread; the simulator's own stages, called one "
              "by one.\n\n"
              "| rung | stage | CPU, ms | share |\n| --- | --- | ---: | ---: |\n";
  for (const StageTimes& stages : results.stages) {
    for (const auto& [name, ms] : stages.stages) {
      markdown << "| " << sim::to_string(stages.rung) << " | " << name << " | " << fixed(ms, 1)
               << " | " << fixed(100 * ms / stages.total_ms(), 0) << " % |\n";
    }
  }
  for (const StageTimes& stages : results.stages) {
    if (stages.once_ms > 0) {
      markdown << "\n"
               << sim::to_string(stages.rung) << ": " << fixed(stages.once_ms, 0)
               << " ms of CPU time before the first stick (tables, homogeneous speckle).\n";
    }
    if (stages.scatterers == 0) continue;
    const double search_ms = stages.stages.at(2).second;
    const auto echoes = static_cast<double>(stages.scatterers);
    markdown << "\n"
             << sim::to_string(stages.rung) << ": " << fixed(1e-6 * echoes, 1)
             << " million echoes of scatterers a volume, " << fixed(1e6 * search_ms / echoes, 1)
             << " ns of CPU time each.\n";
  }
}

void write_memory(const RungsResults& results, std::ostream& markdown) {
  if (results.memory.empty()) return;
  markdown
      << "\n## Memory\n\nLargest resident size of a process of its own (getrusage) that builds the "
         "phantom and scans one volume.\n\n| process | peak, MB | over the phantom's |\n"
         "| --- | ---: | ---: |\n";
  for (const MemoryPeak& peak : results.memory) {
    markdown << "| " << peak.what << " | " << fixed(1e-6 * peak.bytes, 0) << " | "
             << fixed(1e-6 * (peak.bytes - results.memory.front().bytes), 0) << " |\n";
  }
}

void write_growth(const RungsResults& results, std::ostream& markdown) {
  markdown
      << "\n## Growth\n\nA block of tissue in fluid, 12 frames of 32 sticks; each size by itself, "
      << GrowthInputs{}.repeats
      << " times after one uncounted. Exponent of the median time of a moving volume over the "
         "number of …; behind a slash that of the first volume of a seed.\n\n"
         "| rung | sticks | frames | samples | scatterers |\n| --- | ---: | ---: | ---: | ---: |\n";
  for (const sim::Rung rung : volume_rungs()) {
    markdown << "| " << sim::to_string(rung);
    for (const char* what : {"sticks", "frames", "samples", "scatterers"}) {
      const double moving = growth_exponent(results.growth, what, rung, &VolumeTime::moving_ms);
      const double first = growth_exponent(results.growth, what, rung, &VolumeTime::first_ms);
      markdown << " | "
               << (std::isfinite(moving) ? fixed(moving, 2) + " / " + fixed(first, 2) : "");
    }
    markdown << " |\n";
  }
  markdown << "\n| tissue, share of the samples | rung | moving volume, ms | first volume, ms |\n"
              "| ---: | --- | ---: | ---: |\n";
  for (const GrowthPoint& point : results.growth) {
    if (point.what != "tissue") continue;
    markdown << "| " << fixed(100 * point.size, 0) << " %"
             << " | " << sim::to_string(point.rung) << " | " << spread_text(point.time.moving_ms, 1)
             << " | " << spread_text(point.time.first_ms, 1) << " |\n";
  }
}

}  // namespace

std::string rungs_markdown(const RungsResults& results, const Provenance& provenance) {
  std::ostringstream markdown;
  write_head(results, provenance, markdown);
  const auto figures = rungs_figures(results);
  const auto show = [&](const std::string& name) {
    for (const Figure& figure : figures) {
      if (figure.name != name) continue;
      markdown << "\n[Chart: " << figure.caption << "](" << rungs_figure_file(figure) << ")\n";
    }
  };
  write_rungs(results, markdown);
  show("rungs");
  markdown << "\n![The middle frame of " << results.phantom
           << " on each rung: display range and depth as in the scene.](rungs_frames.png)\n";
  write_times(results, markdown);
  write_stages(results, markdown);
  show("stages");
  write_memory(results, markdown);
  write_growth(results, markdown);
  show("growth");
  show("tissue");
  return markdown.str();
}

namespace {

constexpr int kDigits = 9;

/// Lines of the file.
class Rows {
 public:
  void add(const std::string& table,
           const std::string& body,
           const std::string& rung,
           std::string what,
           double value,
           const std::string& unit) {
    for (char& c : what) c = c == ',' ? ' ' : c;
    text_ << table << "," << body << "," << rung << "," << what << ","
          << significant(value, kDigits) << "," << unit << "\n";
  }
  void add(const std::string& table,
           const std::string& body,
           const std::string& rung,
           const std::string& what,
           const Spread& ms) {
    add(table, body, rung, what + "_median", ms.median, "ms");
    add(table, body, rung, what + "_min", ms.min, "ms");
    add(table, body, rung, what + "_max", ms.max, "ms");
  }
  std::string text() const { return "table,body,rung,what,value,unit\n" + text_.str(); }

 private:
  std::ostringstream text_;
};

void add_times(const RungsResults& results, Rows& rows) {
  for (const RungTime& time : results.times) {
    const std::string rung = sim::to_string(time.rung);
    rows.add("time", results.phantom, rung, "map", time.map_ms);
    rows.add("time", results.phantom, rung, "once", time.once_ms);
    rows.add("time", results.phantom, rung, "first", time.first_ms);
    rows.add("time", results.phantom, rung, "still", time.still_ms);
    rows.add("time", results.phantom, rung, "moving", time.moving_ms);
    rows.add("time", results.phantom, rung, "bending", time.bending_ms);
  }
  for (const StageTimes& stages : results.stages) {
    const std::string rung = sim::to_string(stages.rung);
    rows.add("stage", results.phantom, rung, "once", stages.once_ms, "ms");
    for (const auto& [name, ms] : stages.stages) {
      rows.add("stage", results.phantom, rung, name, ms, "ms");
    }
    rows.add("stage",
             results.phantom,
             rung,
             "echoes of scatterers",
             static_cast<double>(stages.scatterers),
             "1");
  }
}

void add_depth(const RungError& error,
               const std::string& against,
               const RangeError& spread,
               Rows& rows) {
  const std::string rung = sim::to_string(error.rung);
  rows.add("error", error.body, rung, against + " median", spread.median_mm, "mm");
  rows.add("error", error.body, rung, against + " median size", spread.median_abs_mm, "mm");
  rows.add("error", error.body, rung, against + " p95 size", spread.p95_abs_mm, "mm");
  rows.add("error", error.body, rung, against + " missed", spread.missed_percent, "%");
  rows.add("error", error.body, rung, against + " sticks", static_cast<double>(spread.n), "1");
}

void add_errors(const RungsResults& results, Rows& rows) {
  for (const RungError& error : results.errors) {
    const std::string rung = sim::to_string(error.rung);
    add_depth(error, "truth", error.against_truth, rows);
    if (error.against_above) add_depth(error, "above", *error.against_above, rows);
    if (!error.image_rms_db) continue;
    rows.add("error", error.body, rung, "above image rms", *error.image_rms_db, "dB");
    rows.add("error", error.body, rung, "above image correlation", *error.image_correlation, "1");
  }
}

}  // namespace

std::string rungs_csv(const RungsResults& results) {
  Rows rows;
  add_times(results, rows);
  for (const GrowthPoint& point : results.growth) {
    const std::string rung = sim::to_string(point.rung),
                      what = point.what + "=" + significant(point.size, kDigits);
    rows.add("growth", "block", rung, what + " first", point.time.first_ms);
    rows.add("growth", "block", rung, what + " moving", point.time.moving_ms);
  }
  add_errors(results, rows);
  for (const MemoryPeak& peak : results.memory) {
    rows.add("memory", results.phantom, "", peak.what, peak.bytes, "bytes");
  }
  return rows.text();
}

namespace {

using Json = nlohmann::ordered_json;

const RungError* error_of(const RungsResults& results, sim::Rung rung) {
  for (const RungError& error : results.errors) {
    if (error.body == results.phantom && error.rung == rung) return &error;
  }
  return nullptr;
}

}  // namespace

Json rungs_json(const RungsResults& results) {
  Json points = Json::array(), front = Json::array();
  struct Point {
    std::string rung;
    double time;
    double error;
  };
  std::vector<Point> all;
  for (const RungTime& time : results.times) {
    const RungError* error = error_of(results, time.rung);
    if (error == nullptr) continue;
    all.push_back({sim::to_string(time.rung),
                   time.first_ms.median / results.sound_ms,
                   error->against_truth.p95_abs_mm});
  }
  for (const Point& point : all) {
    points.push_back({{"settings", {{"simulation.fidelity", point.rung}}},
                      {"time_ratio", point.time},
                      {"error_mm_p95", point.error}});
    const bool beaten = std::any_of(all.begin(), all.end(), [&](const Point& other) {
      return other.time <= point.time && other.error <= point.error &&
             (other.time < point.time || other.error < point.error);
    });
    if (!beaten) front.push_back(point.rung);
  }
  return {{"points", points}, {"front", front}};
}

std::string rungs_figure_file(const Figure& figure) {
  return "rungs_" + figure.name + ".vl.json";
}

}  // namespace wobblebench::bench
