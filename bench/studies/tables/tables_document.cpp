#include <algorithm>
#include <cctype>
#include <sstream>

#include "base/number_text.h"
#include "bench/studies/tables/tables_report.h"
#include "bench/studies/tables/tables_rows.h"

namespace wobblebench::bench {

namespace {

/// "table_ii".
std::string name_of(const PaperTable& table) {
  std::string name = "table_" + table.id;
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return name;
}

Table named(Table table, const std::string& name, const std::string& caption = "") {
  table.name = name;
  table.caption = caption;
  return table;
}

/// Keys of a pass in both pipelines and of their ratio. A pass that only plain has is in the
/// frame's time.
std::vector<std::string> pass_keys(const MeasuredRow& row) {
  std::vector<std::string> keys = {"setting"};
  for (const PassTiming& pass : row.timings.at(PipelineVariant::fast).passes) {
    keys.push_back("plain_" + pass.name + "_ms");
    keys.push_back("fast_" + pass.name + "_ms");
    keys.push_back(pass.name + "_speed_up");
  }
  return keys;
}

std::vector<std::string> variant_keys(const PaperTable& table) {
  std::vector<std::string> keys = {"setting"};
  for (const PipelineVariant variant : variants_of(table)) {
    keys.push_back(to_string(variant) + "_ms");
    keys.push_back(to_string(variant) + "_ratio");
  }
  return keys;
}

std::string growth_of(const MeasuredTable& table) {
  if (!table.exponents) return "";
  return "Time grows as the side to the power " + fixed(table.exponents->paper, 2) + " (paper), " +
         fixed(table.exponents->plain, 2) + " (plain), " + fixed(table.exponents->fast, 2) +
         " (fast): least squares of log time on log side.";
}

void add_table(const MeasuredTable& table, const Table& rows, Document& document) {
  const std::string name = name_of(table.table), &id = table.table.id;
  document.add(Heading{"Table " + id + ": " + table.table.title});
  document.add(named(part_of(rows,
                             id,
                             {"setting",
                              "side",
                              "paper_ms",
                              "plain_ms",
                              "fast_ms",
                              "speed_up",
                              "paper_ratio",
                              "plain_ratio",
                              "fast_ratio"}),
                     name));
  document.add(named(part_of(rows, id, pass_keys(table.rows.front())), name + "_passes"));
  if (variants_of(table.table).size() > 2) {
    document.add(named(part_of(rows, id, variant_keys(table.table)),
                       name + "_variants",
                       "Taps of the 3D kernel in the slices, or along the ray"));
  }
  if (table.exponents) document.add(Text{growth_of(table)});
}

void add_arrival(const TableResults& results, const Table& rows, Document& document) {
  constexpr int kDigits = 3;
  document.add(Heading{"What arrives"});
  document.add(
      Text{"At the reference settings. One frame: pass 1 for what it settles, from its arrival "
           "until GL is done, over all frames of the volume; a frame is acquired in " +
           significant(results.frame_acquisition_ms, kDigits) +
           " ms. New volume: upload and four passes. New view: passes 2 to 4 of the same volume "
           "from 10 degrees aside."});
  document.add(named(part_of(rows,
                             "arrival",
                             {"setting",
                              "plain_ms",
                              "fast_ms",
                              "speed_up",
                              "acquisition_ms",
                              "plain_times_acquisition",
                              "fast_times_acquisition"}),
                     "arrival"));
}

void add_stages(const TableResults& results, Document& document) {
  using S = StageTimes;
  const auto column = [](const char* key, const char* title, std::vector<double> S::*ms) {
    return Field<S>({key, title, "ms", 3, true}, [ms](const S& of) { return spread_of(of.*ms); });
  };
  Table table = table_of<S>({.name = "stages"},
                            results.stages,
                            {{{"settings"}, &S::settings},
                             {{"frames", "frames a volume", "", 0}, &S::frames},
                             column("frame_ms", "one frame", &S::frame_ms),
                             column("last_frame_ms", "last frame", &S::last_frame_ms),
                             column("picture_ms", "new picture", &S::picture_ms),
                             column("new_view_ms", "new view", &S::new_view_ms)});
  document.add(Heading{"Stages of a stream"})
      .add(Text{
          "The paper's settings and the default ones, on the wall clock: upload and pass 1 of "
          "a frame; the same of a volume's last frame; passes 2 to 4 with reading the picture; "
          "likewise from 10 degrees aside. Median, least and most. `wobblebench latency "
          "--times report.json` predicts a stream on this machine by them."})
      .add(std::move(table));
}

double millions(std::int64_t fetches) {
  return 1e-6 * static_cast<double>(fetches);
}

Table floor_table(const TableResults& results) {
  Table table{.name = "floor",
              .columns = {{"pipeline"},
                          {"pass"},
                          {"fetches_millions", "fetches", "millions"},
                          {"floor_ms", "floor", "ms", 3, true},
                          {"measured_ms", "measured", "ms", 3, true},
                          {"times_floor", "measured / floor", "", 3, true}}};
  for (const auto& [variant, passes] : results.floors.passes) {
    for (const PassFloor& floor : passes) {
      const double ms = pass_ms(results.reference.timings.at(variant), floor.pass);
      table.add({to_string(variant),
                 floor.pass,
                 millions(floor.total()),
                 floor.floor_ms,
                 ms,
                 floor.floor_ms > 0 ? Cell(ms / floor.floor_ms) : Cell("none")});
    }
  }
  return table;
}

Table rates_table(const TableResults& results) {
  Table table{.name = "fetches",
              .columns = {{"fetch"}, {"per_us", "rate", "millions a second", 0}}};
  for (const auto& [variant, passes] : results.floors.passes) {
    table.columns.push_back({to_string(variant) + "_millions", to_string(variant), "millions"});
  }
  for (const auto& [kind, rate] : results.floors.rates_per_us) {
    std::vector<Cell> cells = {to_string(kind), rate};
    for (const auto& [variant, passes] : results.floors.passes) {
      std::int64_t count = 0;
      for (const PassFloor& floor : passes) {
        const auto found = floor.fetches.find(kind);
        if (found != floor.fetches.end()) count += found->second;
      }
      cells.emplace_back(millions(count));
    }
    table.add(std::move(cells));
  }
  return table;
}

void add_floor(const TableResults& results, Document& document) {
  document.add(Heading{"Where the time goes"});
  document.add(Text{
      "At the reference settings. Fetches: counted by the shaders of one whole frame. Floor: as "
      "long as these fetches take in loops that do nothing else, at the rates below (the fastest "
      "of 7 draws). A pass's time holds what is no fetch, too: arithmetic, pixels that wait for "
      "their neighbours, the CPU's part."});
  document.add(floor_table(results));
  document.add(rates_table(results));
}

/// The paper's reference settings in each pipeline, beside the paper's time.
KeyFigures answer_of(const TableResults& results) {
  const MeasuredRow& row = results.reference;
  KeyFigures figures;
  for (const auto& [variant, timing] : row.timings) {
    const Spread& ms = timing.frame_ms;
    figures.add("Reference volume, " + to_string(variant),
                ms.median,
                "frame_ms",
                "median, from " + fixed(ms.min, 1) + " to " + fixed(ms.max, 1) +
                    " ms; the paper's GPU: " + significant(row.row.paper_ms, 3) + " ms");
  }
  return figures;
}

std::string origin_of(const Provenance& provenance) {
  std::string text = "CPU: " + provenance.cpu + ", " + std::to_string(provenance.threads) +
                     " threads. GL: " + provenance.gl_backend + ", " + provenance.gl_renderer +
                     ". Commit: " + provenance.commit + ".";
  if (provenance.board == "simulated") text += " Seed: " + std::to_string(provenance.seed) + ".";
  return text + " Sticks: " + provenance.board + ".";
}

}  // namespace

void add_agreement(const PicturesAgainst& against, Document& document) {
  using P = PictureAgreement;
  Table table = table_of<P>({.name = "agreement"},
                            against.agreements,
                            {{{"settings"}, &P::settings},
                             {{"pixels", "surface in both", "pixels", 0}, &P::pixels},
                             {{"z_rms_mm", "z, RMS", "mm", 4}, &P::z_rms_mm},
                             {{"z_p999_mm", "99.9 % below", "mm", 4}, &P::z_p999_mm},
                             {{"z_largest_mm", "largest", "mm", 3}, &P::z_largest_mm},
                             {{"found_in_one_percent", "found in one", "%", 3},
                              [](const P& of) { return 100 * of.found_in_one_share; }},
                             {{"unexplained_percent", "unexplained", "%", 3},
                              [](const P& of) { return 100 * of.unexplained_share; }},
                             {{"light_rms", "light, RMS", "", 5}, &P::light_rms},
                             {{"light_largest", "largest", "", 3}, &P::light_largest}});
  document.add(Heading{"The picture against another context's"})
      .add(Text{"The same recording by " + against.other +
                ". z: of pass 2. A GPU rounds the fractions of its linear filters to 8 bits: a "
                "sample may be off by 4/512 of full scale. z is explained where it lies between "
                "those that the other context finds with the detector's level so far below and "
                "above; at most " +
                fixed(100 * kMostUnexplained, 1) +
                " % of the pixels may not. Light: linear RGB in [0, 1]."})
      .add(std::move(table));
}

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

Document tables_document(const TableResults& results,
                         const TableRun& run,
                         const std::string& note,
                         const Provenance& provenance) {
  const Table rows = all_rows(results, run);
  Document document{.title = "Tables I to IV", .name = "tables"};
  document.add(answer_of(results)).add(Text{origin_of(provenance)}).add(Text{describe_run(run)});
  if (!note.empty()) document.add(Text{note});
  for (const Figure& figure : tables_figures(results, run)) document.add(figure);
  for (const MeasuredTable& table : results.tables) add_table(table, rows, document);
  add_arrival(results, rows, document);
  add_stages(results, document);
  add_floor(results, document);
  document.data = {{"tables.csv", rows}};
  return document;
}

}  // namespace wobblebench::bench
