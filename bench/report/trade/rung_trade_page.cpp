#include <cmath>
#include <cstdio>
#include <sstream>

#include "bench/studies/trade/rung_trade.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

/// printf, as a string.
template <class... Values>
std::string format(const char* pattern, Values... values) {
  char text[400];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

std::string spread_text(const Spread& ms, int decimals = 0) {
  return format("%.*f (%.*f to %.*f)", decimals, ms.median, decimals, ms.min, decimals, ms.max);
}

/// How much faster than sound.
std::string times_real(double ms, double sound_ms) {
  const double times = sound_ms / ms;
  return format(times < 9.95 ? "%.1f" : "%.0f", times);
}

const RungTime* time_of(const RungTradeResults& results, sim::Rung rung) {
  for (const RungTime& time : results.times) {
    if (time.rung == rung) return &time;
  }
  return nullptr;
}

void write_head(const RungTradeResults& results, const Provenance& provenance, std::ostream& page) {
  page << "# Trade of the simulator's rungs\n\n"
       << "Made by `wobblebench trade`. Commit " << provenance.commit << ", " << provenance.cpu
       << ", " << provenance.threads << " threads. Phantom " << results.phantom
       << "; a volume's sound takes " << format("%.1f ms", results.sound_ms) << ". Seeds "
       << results.seeds.front() << " to " << results.seeds.back()
       << ". Times are wall times of all threads, median (least to most) of " << results.repeats
       << " after one uncounted, the rungs in turn in each repeat. All rows are in `trade.csv`.\n";
}

void write_trade(const RungTradeResults& results, std::ostream& page) {
  page
      << "\n## Time and error\n\n"
         "Error against the truth: where a stick first shows tissue (mean of three samples above "
         "0.3 "
         "of the display) less where it meets the surface. Error against the rung above: the same "
         "between the two, and the difference of what is displayed, averaged over the seeds, where "
         "either shows anything.\n\n"
         "| body | rung | first volume, ms | times real time | surface against truth: median, P95, "
         "mm; "
         "missed | surface against the rung above: median, P95, mm | image against the rung above: "
         "RMS, dB; correlation |\n| --- | --- | ---: | ---: | ---: | ---: | ---: |\n";
  for (const RungError& error : results.errors) {
    const RungTime* time = time_of(results, error.rung);
    const bool timed = time != nullptr && error.body == results.phantom;
    page << "| " << error.body << " | " << sim::to_string(error.rung) << " | "
         << (timed ? format("%.0f", time->first_ms.median) : "") << " | "
         << (timed ? times_real(time->first_ms.median, results.sound_ms) : "") << " | "
         << format("%.2f, %.2f; %.1f %%",
                   error.against_truth.median_mm,
                   error.against_truth.p95_size_mm,
                   error.against_truth.missed_percent)
         << " | "
         << (error.against_above ? format("%.2f, %.2f",
                                          error.against_above->median_size_mm,
                                          error.against_above->p95_size_mm)
                                 : "none above")
         << " | "
         << (error.image_rms_db
                 ? format("%.2f; %.4f", *error.image_rms_db, *error.image_correlation)
                 : "none above")
         << " |\n";
  }
  page << format(
      "\n`reference` sums over the probe's elements and is for small scenes: on the sheet above (4 "
      "sticks) "
      "a volume takes %s ms, against %s ms by `scatterers`, %.0f times as long (%d repeats).\n",
      spread_text(results.small_reference.first_ms).c_str(),
      spread_text(results.small_scatterers.first_ms, 1).c_str(),
      results.small_reference.first_ms.median / results.small_scatterers.first_ms.median,
      kSmallRepeats);
}

void write_times(const RungTradeResults& results, std::ostream& page) {
  page << "\n## Time of a volume\n\n"
          "Map: the phantom's surfaces brought onto one lattice, once for a phantom. Once for a "
          "seed: "
          "tables, even speckle and, as nothing moves, all echoes. Still: a further volume, its "
          "noise "
          "and receive chain. Moving: of "
       << kVolumesInARow
       << " volumes in a row of the phantom on a path, each; bending: and its head "
          "turning. "
          "Behind a slash: times real time.\n\n"
          "| rung | map, ms | once for a seed, ms | first volume, ms | further still volume, ms | "
          "moving, "
          "ms | bending, ms |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: |\n";
  for (const RungTime& time : results.times) {
    const auto cell = [&](const Spread& ms) {
      return spread_text(ms) + " / " + times_real(ms.median, results.sound_ms);
    };
    page << "| " << sim::to_string(time.rung) << " | " << spread_text(time.map_ms) << " | "
         << spread_text(time.once_ms) << " | " << cell(time.first_ms) << " | "
         << cell(time.still_ms) << " | " << cell(time.moving_ms) << " | " << cell(time.bending_ms)
         << " |\n";
  }
  page << "\nThe floor is the design's estimate for two AVX2 cores: 10 ms for the 1.21 million "
          "samples of "
          "a volume of `field` (50 multiplications and additions a sample, look-ups, hashes), 0.2 "
          "s for "
          "47 million scatterers' echoes.\n\n"
          "| rung | floor, ms | moving volume over floor | first volume over floor |\n"
          "| --- | ---: | ---: | ---: |\n";
  for (const RungTime& time : results.times) {
    const double floor = floor_ms(time.rung, results);
    if (floor == 0) continue;
    page << format("| %s | %.0f | %.1f | %.1f |\n",
                   sim::to_string(time.rung).c_str(),
                   floor,
                   time.moving_ms.median / floor,
                   time.first_ms.median / floor);
  }
}

void write_stages(const RungTradeResults& results, std::ostream& page) {
  page << "\n## Where the time goes\n\n"
          "CPU time of a moving volume on one thread; the simulator's own stages, called one by "
          "one.\n\n"
          "| rung | stage | CPU, ms | share |\n| --- | --- | ---: | ---: |\n";
  for (const StageTimes& stages : results.stages) {
    for (const auto& [name, ms] : stages.stages) {
      page << format("| %s | %s | %.1f | %.0f %% |\n",
                     sim::to_string(stages.rung).c_str(),
                     name.c_str(),
                     ms,
                     100 * ms / stages.total_ms());
    }
  }
  for (const StageTimes& stages : results.stages) {
    if (stages.once_ms > 0) {
      page << format("\n%s: %.0f ms of CPU time before the first stick (tables, even speckle).\n",
                     sim::to_string(stages.rung).c_str(),
                     stages.once_ms);
    }
    if (stages.scatterers == 0) continue;
    const double search_ms = stages.stages.at(2).second;
    page << format("\n%s: %.1f million echoes of scatterers a volume, %.1f ns of CPU time each.\n",
                   sim::to_string(stages.rung).c_str(),
                   1e-6 * static_cast<double>(stages.scatterers),
                   1e6 * search_ms / static_cast<double>(stages.scatterers));
  }
}

void write_memory(const RungTradeResults& results, std::ostream& page) {
  if (results.memory.empty()) return;
  page
      << "\n## Memory\n\nLargest resident size of a process of its own (getrusage) that builds the "
         "phantom and scans one volume.\n\n| process | peak, MB | over the phantom's |\n"
         "| --- | ---: | ---: |\n";
  for (const MemoryPeak& peak : results.memory) {
    page << format("| %s | %.0f | %.0f |\n",
                   peak.what.c_str(),
                   1e-6 * peak.bytes,
                   1e-6 * (peak.bytes - results.memory.front().bytes));
  }
}

void write_growth(const RungTradeResults& results, std::ostream& page) {
  page
      << "\n## Growth\n\nA block of tissue in fluid, 12 frames of 32 sticks; each size by itself, "
      << GrowthInputs{}.repeats
      << " times after one uncounted. Exponent of the median time of a moving volume over the "
         "number of …; behind a slash that of the first volume of a seed.\n\n"
         "| rung | sticks | frames | samples | scatterers |\n| --- | ---: | ---: | ---: | ---: |\n";
  for (const sim::Rung rung : volume_rungs()) {
    page << "| " << sim::to_string(rung);
    for (const char* what : {"sticks", "frames", "samples", "scatterers"}) {
      const double moving = growth_exponent(results.growth, what, rung, &VolumeTime::moving_ms);
      const double first = growth_exponent(results.growth, what, rung, &VolumeTime::first_ms);
      page << " | " << (std::isfinite(moving) ? format("%.2f / %.2f", moving, first) : "");
    }
    page << " |\n";
  }
  page << "\n| tissue, share of the samples | rung | moving volume, ms | first volume, ms |\n"
          "| ---: | --- | ---: | ---: |\n";
  for (const GrowthPoint& point : results.growth) {
    if (point.what != "tissue") continue;
    page << format("| %.0f %% | %s | %s | %s |\n",
                   100 * point.size,
                   sim::to_string(point.rung).c_str(),
                   spread_text(point.time.moving_ms, 1).c_str(),
                   spread_text(point.time.first_ms, 1).c_str());
  }
}

}  // namespace

std::string trade_page(const RungTradeResults& results, const Provenance& provenance) {
  std::ostringstream page;
  write_head(results, provenance, page);
  const auto figures = trade_figures(results);
  const auto show = [&](const std::string& name) {
    for (const Figure& figure : figures) {
      if (figure.name != name) continue;
      page << "\n![" << figure.caption << "](" << trade_figure_file(figure) << ")\n";
    }
  };
  write_trade(results, page);
  show("rungs");
  show("frames");
  write_times(results, page);
  write_stages(results, page);
  show("stages");
  write_memory(results, page);
  write_growth(results, page);
  show("growth");
  show("tissue");
  return page.str();
}

}  // namespace wobblebench::bench
