#include <sstream>

#include "base/number_text.h"
#include "bench/studies/tables/tables_report.h"

namespace wobblebench::bench {

namespace {

/// About three significant digits, for times between 0.01 ms and half a minute.
std::string ms_text(double ms) {
  return fixed(ms, ms >= 100 ? 0 : ms >= 10 ? 1 : ms >= 1 ? 2 : 3);
}

std::string spread_text(const Spread& spread) {
  return ms_text(spread.min) + " – " + ms_text(spread.max);
}

/// Quartiles in brackets, where they differ.
std::string ratio_text(const Quartiles& ratio) {
  if (ratio.lower == ratio.upper) return fixed(ratio.median, 2);
  return fixed(ratio.median, 2) + " (" + fixed(ratio.lower, 2) + " – " + fixed(ratio.upper, 2) +
         ")";
}

std::string times_text(double times) {
  return fixed(times, times >= 100 ? 0 : times >= 10 ? 1 : 2) + "×";
}

/// A line of a Markdown table.
std::string line(const std::vector<std::string>& cells) {
  std::string text = "|";
  for (const auto& cell : cells) text += " " + cell + " |";
  return text + "\n";
}

/// The first column left-aligned, the others right-aligned.
std::string head(const std::vector<std::string>& cells) {
  std::vector<std::string> rule(cells.size(), "---:");
  rule.front() = "---";
  return line(cells) + line(rule);
}

std::string times_of(const MeasuredTable& table) {
  std::string text = head({"setting",
                           "paper ms",
                           "plain ms",
                           "min – max",
                           "fast ms",
                           "min – max",
                           "plain / fast",
                           "paper ratio",
                           "plain ratio",
                           "fast ratio"});
  for (const MeasuredRow& row : table.rows) {
    const Timing& plain = row.timings.at(PipelineVariant::plain);
    const Timing& fast = row.timings.at(PipelineVariant::fast);
    text += line({row.row.setting,
                  ms_text(row.row.paper_ms),
                  ms_text(plain.frame_ms.median),
                  spread_text(plain.frame_ms),
                  ms_text(fast.frame_ms.median),
                  spread_text(fast.frame_ms),
                  times_text(row.speed_up()),
                  fixed(row.paper_ratio, 2),
                  ratio_text(plain.ratio),
                  ratio_text(fast.ratio)});
  }
  return text;
}

/// Columns: the passes of the fast variant. A pass that only plain has is in the frame's time.
std::string passes_of(const MeasuredTable& table) {
  std::vector<std::string> names = {"plain / fast, ms"};
  for (const auto& pass : table.rows.front().timings.at(PipelineVariant::fast).passes) {
    names.push_back(pass.name);
  }
  std::string text = head(names);
  for (const MeasuredRow& row : table.rows) {
    std::vector<std::string> cells = {row.row.setting};
    for (const auto& fast : row.timings.at(PipelineVariant::fast).passes) {
      std::string plain_ms = "none";
      for (const auto& plain : row.timings.at(PipelineVariant::plain).passes) {
        if (plain.name == fast.name) plain_ms = ms_text(plain.ms);
      }
      const auto times = row.pass_speed_up(fast.name);
      cells.push_back(plain_ms + " / " + ms_text(fast.ms) +
                      (times ? " = " + times_text(*times) : ""));
    }
    text += line(cells);
  }
  return text;
}

/// All variants with their spread, where there are more than two.
std::string all_variants_of(const MeasuredTable& table) {
  const auto variants = variants_of(table.table);
  if (variants.size() < 3) return "";
  std::vector<std::string> names = {"taps of the kernel in the slices, or along the ray"};
  for (const PipelineVariant variant : variants) {
    names.push_back(to_string(variant) + " ms");
    names.emplace_back("ratio");
  }
  std::string text = "\n" + head(names);
  for (const MeasuredRow& row : table.rows) {
    std::vector<std::string> cells = {row.row.setting};
    for (const PipelineVariant variant : variants) {
      const Timing& timing = row.timings.at(variant);
      cells.push_back(ms_text(timing.frame_ms.median) + " (" + spread_text(timing.frame_ms) + ")");
      cells.push_back(ratio_text(timing.ratio));
    }
    text += line(cells);
  }
  return text;
}

std::string growth_of(const MeasuredTable& table) {
  if (!table.exponents) return "";
  return "\nTime grows as the side to the power " + fixed(table.exponents->paper, 2) +
         " (paper), " + fixed(table.exponents->plain, 2) + " (plain), " +
         fixed(table.exponents->fast, 2) + " (fast): least squares of log time on log side.\n";
}

std::string arrival_of(const TableResults& results) {
  std::string text =
      "\n### What arrives\n\nAt the reference settings. One frame: pass 1 for what it settles, "
      "from its arrival until GL is done, over all frames of the volume; a frame is acquired in " +
      ms_text(results.frame_acquisition_ms) +
      " ms. New volume: upload and four passes. New view: passes 2 to 4 of the same volume from 10 "
      "degrees aside.\n\n" +
      head({"pipeline",
            "one frame ms",
            "min – max",
            "faster than acquired",
            "new volume ms",
            "min – max",
            "new view ms",
            "min – max"});
  for (const auto& [variant, arrival] : results.arrivals) {
    text += line({to_string(variant),
                  ms_text(arrival.add_frame_ms.median),
                  spread_text(arrival.add_frame_ms),
                  times_text(results.times_acquisition(variant)),
                  ms_text(arrival.new_volume_ms.median),
                  spread_text(arrival.new_volume_ms),
                  ms_text(arrival.new_view_ms.median),
                  spread_text(arrival.new_view_ms)});
  }
  return text;
}

std::string floor_of(const TableResults& results) {
  std::string text =
      "\n### Where the time goes\n\nAt the reference settings. Fetches: counted by the shaders of "
      "one whole frame. Floor: as long as these fetches take in loops that do nothing else, at the "
      "rates below (millions a second; the fastest of 7 draws). A pass's time holds what is no "
      "fetch, too: arithmetic, pixels that wait for their neighbours, the CPU's part.\n\n" +
      head({"pipeline", "pass", "fetches, millions", "floor ms", "measured ms", "of the floor"});
  for (const auto& [variant, passes] : results.floors.passes) {
    for (const PassFloor& floor : passes) {
      const double ms = pass_ms(results.reference.timings.at(variant), floor.pass);
      text += line({to_string(variant),
                    floor.pass,
                    fixed(1e-6 * static_cast<double>(floor.total()), 2),
                    ms_text(floor.floor_ms),
                    ms_text(ms),
                    floor.floor_ms > 0 ? times_text(ms / floor.floor_ms) : "none"});
    }
  }
  text += "\n" + head({"fetch", "millions a second", "plain, millions", "fast, millions"});
  for (const auto& [kind, rate] : results.floors.rates_per_us) {
    std::vector<std::string> cells = {to_string(kind), fixed(rate, 0)};
    for (const auto& [variant, passes] : results.floors.passes) {
      std::int64_t count = 0;
      for (const PassFloor& floor : passes) {
        const auto found = floor.fetches.find(kind);
        if (found != floor.fetches.end()) count += found->second;
      }
      cells.push_back(fixed(1e-6 * static_cast<double>(count), 2));
    }
    text += line(cells);
  }
  return text;
}

std::string origin_of(const Provenance& provenance) {
  std::string text = "CPU: " + provenance.cpu + ", " + std::to_string(provenance.threads) +
                     " threads. GL: " + provenance.gl_backend + ", " + provenance.gl_renderer +
                     ". Commit: " + provenance.commit + ".";
  if (provenance.board == "simulated") text += " Seed: " + std::to_string(provenance.seed) + ".";
  return text + " Sticks: " + provenance.board + ".";
}

}  // namespace

std::string describe_run(const TableRun& run) {
  std::ostringstream text;
  if (run.divisor == 1) {
    text << "The paper's sizes.";
  } else {
    text << "REDUCED: slice, image and ray steps are 1/" << run.divisor
         << " of the paper's in each direction (512^3 is run as " << 512 / run.divisor
         << "^3); frames, sticks, samples and kernels are the paper's. --full runs the paper's "
            "sizes.";
  }
  text << " plain: each sample and pixel by itself, taps of the 3D kernel along the ray; fast: "
          "the default, taps in the slices. Each setting: median of "
       << run.plain_repeats << " (plain) and " << run.repeats
       << " (fast) after one uncounted, all settings in turn in each repeat; a setting that "
          "several tables share is measured once. Time: four passes, all frames, upload included, "
          "the picture not read back. Ratios are to 37 frames, 512^3, 3x3x3, 9x9, in the same "
          "repeat: median and, where there are several, quartiles.";
  return text.str();
}

std::string to_markdown(const TableResults& results,
                        const TableRun& run,
                        const std::string& note,
                        const Provenance& provenance) {
  std::string text = origin_of(provenance) + "\n\n" + describe_run(run) + "\n";
  if (!note.empty()) text += "\n" + note + "\n";
  for (const MeasuredTable& table : results.tables) {
    text += "\n### Table " + table.table.id + ": " + table.table.title + "\n\n" + times_of(table) +
            "\n" + passes_of(table) + all_variants_of(table) + growth_of(table);
  }
  return text + arrival_of(results) + floor_of(results);
}

}  // namespace wobblebench::bench
