#include "bench/studies/rungs/rungs_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/number_text.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

constexpr const char* kSizes[] = {"sticks", "frames", "samples", "scatterers"};

std::string spread_text(const Spread& ms, int digits = 0) {
  return fixed(ms.median, digits) + " (" + fixed(ms.min, digits) + " to " + fixed(ms.max, digits) +
         ")";
}

const RungTime* time_of(const RungsResults& results, sim::Rung rung) {
  for (const RungTime& time : results.times) {
    if (time.rung == rung) return &time;
  }
  return nullptr;
}

std::string origin_of(const RungsResults& results, const Provenance& provenance) {
  return "Made by `wobblebench rungs`. Commit " + provenance.commit + ", " + provenance.cpu + ", " +
         std::to_string(provenance.threads) + " threads. Phantom " + results.phantom +
         "; a volume's sound takes " + fixed(results.sound_ms, 1) + " ms. Seeds " +
         std::to_string(results.seeds.front()) + " to " + std::to_string(results.seeds.back()) +
         ". Times are wall times of all threads, median (least to most) of " +
         std::to_string(results.repeats) +
         " after one uncounted, the rungs in turn in each repeat. \"Times real time\" is the "
         "duration of the acquisition over that of its simulation. The tables are also in "
         "`rungs_*.csv`.";
}

constexpr char kErrorMethod[] =
    "Error against the truth: where a stick first shows tissue (mean of three samples above 0.3 of "
    "the display) less where it meets the surface. Error against the rung above: the same between "
    "the two, and the difference of what is displayed, averaged over the seeds, where either shows "
    "anything; empty where no rung is above.";

void add_range_error(const RangeError& error, std::vector<Cell>& row) {
  for (const double value :
       {error.median_mm, error.median_abs_mm, error.p95_abs_mm, error.missed_percent}) {
    row.emplace_back(value);
  }
  row.emplace_back(error.n);
}

Table errors_table(const RungsResults& results) {
  Table table{.name = "errors",
              .columns = {{"body"},
                          {"rung"},
                          {"first_ms", "first volume", "ms", 0},
                          {"times_real_time", "times real time", "", 2, true}}};
  for (const auto& [key, title] :
       {std::pair<std::string, std::string>{"truth", "truth"}, {"above", "the rung above"}}) {
    table.columns.push_back({key + "_median_mm", "surface against " + title + ": median", "mm"});
    table.columns.push_back({key + "_median_size_mm", "median size", "mm"});
    table.columns.push_back({key + "_p95_size_mm", "P95 of the size", "mm"});
    table.columns.push_back({key + "_missed_percent", "missed", "%", 1});
    table.columns.push_back({key + "_sticks", "sticks"});
  }
  table.columns.push_back({"image_rms_db", "image against the rung above: RMS", "dB"});
  table.columns.push_back({"image_correlation", "correlation", "", 4});
  for (const RungError& error : results.errors) {
    const RungTime* time = time_of(results, error.rung);
    const bool timed = time != nullptr && error.body == results.phantom;
    std::vector<Cell> row = {error.body,
                             sim::to_string(error.rung),
                             timed ? Cell(time->first_ms) : Cell(),
                             timed ? Cell(results.sound_ms / time->first_ms.median) : Cell()};
    add_range_error(error.against_truth, row);
    if (error.against_above) add_range_error(*error.against_above, row);
    if (error.image_rms_db) row.emplace_back(*error.image_rms_db);
    if (error.image_correlation) row.emplace_back(*error.image_correlation);
    row.resize(table.columns.size());
    table.add(std::move(row));
  }
  return table;
}

std::string reference_text(const RungsResults& results) {
  const Spread& reference = results.small_reference.first_ms;
  const Spread& scatterers = results.small_scatterers.first_ms;
  return "`reference` sums over the probe's elements and is for small scenes: on the sheet above "
         "(4 "
         "sticks) a volume takes " +
         spread_text(reference) + " ms, against " + spread_text(scatterers, 1) +
         " ms by `scatterers`, " + fixed(reference.median / scatterers.median, 0) +
         " times as long (" + std::to_string(kSmallRepeats) + " repeats).";
}

/// Names of the bodies of which no stick met a surface.
std::string without_surface(const RungsResults& results) {
  std::string names;
  for (const RungError& error : results.errors) {
    if (error.against_truth.n > 0 || error.against_truth.missed_percent > 0) continue;
    if (names.find(error.body) == std::string::npos)
      names += (names.empty() ? "" : ", ") + error.body;
  }
  return names;
}

void add_errors(const RungsResults& results, Document& document) {
  document.add(Heading{"Time and error"}).add(Text{kErrorMethod}).add(errors_table(results));
  const std::string names = without_surface(results);
  if (!names.empty()) {
    document.add(Text{"No stick meets a surface of " + names + ": there is no error to show."});
  }
  document.add(Text{reference_text(results)});
}

std::string times_method() {
  return "Map: the phantom's surfaces brought onto one lattice, once for a phantom. Once for a "
         "seed: tables, homogeneous speckle and, as nothing moves, all echoes. Still: a further "
         "volume, its noise and receive chain. Moving: of " +
         std::to_string(kVolumesInARow) +
         " volumes in a row of the phantom on a path, each; bending: and its head turning.";
}

Table times_table(const RungsResults& results) {
  Table table{
      .name = "times",
      .columns = {{"rung"}, {"map_ms", "map", "ms", 0}, {"once_ms", "once for a seed", "ms", 0}}};
  struct Shown {
    const char* name;
    const char* title;
    Spread RungTime::*ms;
  };
  constexpr Shown kShown[] = {{"first", "first volume", &RungTime::first_ms},
                              {"still", "further still volume", &RungTime::still_ms},
                              {"moving", "moving", &RungTime::moving_ms},
                              {"bending", "bending", &RungTime::bending_ms}};
  for (const Shown& shown : kShown) {
    const std::string name = shown.name;
    table.columns.push_back({name + "_ms", shown.title, "ms", 0});
    table.columns.push_back({name + "_times_real_time", "times real time", "", 2, true});
  }
  for (const RungTime& time : results.times) {
    std::vector<Cell> row = {sim::to_string(time.rung), time.map_ms, time.once_ms};
    for (const Shown& shown : kShown) {
      row.emplace_back(time.*shown.ms);
      row.emplace_back(results.sound_ms / (time.*shown.ms).median);
    }
    table.add(std::move(row));
  }
  return table;
}

void add_memory(const RungsResults& results, Document& document) {
  if (results.memory.empty()) return;
  Table table{.name = "memory",
              .columns = {{"process"},
                          {"peak_mb", "peak", "MB", 0},
                          {"over_phantom_mb", "over the phantom's", "MB", 0}}};
  for (const MemoryPeak& peak : results.memory) {
    table.add({peak.what, 1e-6 * peak.bytes, 1e-6 * (peak.bytes - results.memory.front().bytes)});
  }
  document.add(Heading{"Memory"});
  document.add(
      Text{"Largest resident size of a process of its own (getrusage) that builds the "
           "phantom and scans one volume."});
  document.add(std::move(table));
}

Table exponents_table(const RungsResults& results) {
  Table table{.name = "exponents", .columns = {{"rung"}}};
  for (const std::string what : kSizes) {
    table.columns.push_back({what + "_moving", what + ", moving"});
    table.columns.push_back({what + "_first", what + ", first"});
  }
  for (const sim::Rung rung : volume_rungs()) {
    std::vector<Cell> row = {sim::to_string(rung)};
    for (const char* what : kSizes) {
      row.emplace_back(growth_exponent(results.growth, what, rung, &VolumeTime::moving_ms));
      row.emplace_back(growth_exponent(results.growth, what, rung, &VolumeTime::first_ms));
    }
    table.add(std::move(row));
  }
  return table;
}

Table growth_table(const RungsResults& results) {
  using G = GrowthPoint;
  return table_of<G>(
      {.name = "growth"},
      results.growth,
      {{{"what"}, &G::what},
       {{"size", "size (of tissue: share of the samples)", "", 3, true}, &G::size},
       {{"rung"}, [](const G& of) { return sim::to_string(of.rung); }},
       {{"moving_ms", "moving volume", "ms", 1}, [](const G& of) { return of.time.moving_ms; }},
       {{"first_ms", "first volume", "ms", 1}, [](const G& of) { return of.time.first_ms; }}});
}

void add_growth(const RungsResults& results, Document& document) {
  document.add(Heading{"Growth"});
  document.add(Text{
      "A block of tissue in fluid, 12 frames of 32 sticks; each size by itself, " +
      std::to_string(GrowthInputs{}.repeats) +
      " times after one uncounted. Exponents of the median time over the number of sticks, frames, "
      "samples and scatterers: of a moving volume, and of the first volume of a seed."});
  document.add(exponents_table(results)).add(growth_table(results));
}

using Json = nlohmann::ordered_json;

const RungError* error_of(const RungsResults& results, sim::Rung rung) {
  for (const RungError& error : results.errors) {
    if (error.body == results.phantom && error.rung == rung) return &error;
  }
  return nullptr;
}

/// How many times faster than the sound each rung is, and how far from what it is held against.
KeyFigures answer_of(const RungsResults& results) {
  KeyFigures figures;
  for (const RungTime& time : results.times) {
    const auto of_sound = [&](const Spread& ms) {
      const double times = results.sound_ms / ms.median;
      return fixed(times, times < 10 ? 1 : 0);
    };
    const RungError* const error = error_of(results, time.rung);
    std::string help = "at rest " + of_sound(time.still_ms) + ", the first of a seed " +
                       of_sound(time.first_ms) + " times.";
    if (error != nullptr) {
      help +=
          " Surface against the truth: P95 " + fixed(error->against_truth.p95_abs_mm, 2) + " mm";
      if (error->against_above)
        help += ", against the rung above: " + fixed(error->against_above->p95_abs_mm, 2) + " mm";
    }
    figures.all.push_back({sim::to_string(time.rung) + ", a moving volume",
                           of_sound(time.moving_ms),
                           "times real time",
                           help});
  }
  return figures;
}

}  // namespace

Document rungs_document(const RungsResults& results, const Provenance& provenance) {
  Document document{.title = "Trade of the simulator's rungs", .name = "rungs"};
  document.add(answer_of(results)).add(Text{origin_of(results, provenance)});
  add_errors(results, document);
  document.add(rungs_figure(results));
  document.add(Picture{kFramesFile,
                       "The middle frame of " + results.phantom +
                           " on each rung: display range and depth as in the scene."});
  document.add(Heading{"Time of a volume"}).add(Text{times_method()}).add(times_table(results));
  add_memory(results, document);
  add_growth(results, document);
  document.add(growth_figure(results)).add(tissue_figure(results));
  for (const Block& block : document.blocks) {
    const auto* table = std::get_if<Table>(&block);
    if (table != nullptr) document.data.push_back({"rungs_" + table->name + ".csv", *table});
  }
  return document;
}

Json rungs_json(const RungsResults& results, const Document& document) {
  struct Point {
    std::string rung;
    double ms;
    double p95_mm;
  };
  std::vector<Point> points;
  for (const RungTime& time : results.times) {
    const RungError* error = error_of(results, time.rung);
    if (error == nullptr || error->against_truth.n == 0) continue;
    points.push_back(
        {sim::to_string(time.rung), time.first_ms.median, error->against_truth.p95_abs_mm});
  }
  Json front = Json::array();
  for (const Point& point : points) {
    const bool beaten = std::ranges::any_of(points, [&](const Point& other) {
      return other.ms <= point.ms && other.p95_mm <= point.p95_mm &&
             (other.ms < point.ms || other.p95_mm < point.p95_mm);
    });
    if (!beaten) front.push_back(point.rung);
  }
  Json json = {{"front", front}};
  json.update(tables_json(document));
  return json;
}

}  // namespace wobblebench::bench
