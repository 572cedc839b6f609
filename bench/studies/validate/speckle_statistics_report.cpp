#include <cmath>
#include <sstream>

#include "base/number_text.h"
#include "bench/studies/validate/study_reports.h"
#include "bench/studies/validate/table_comparison.h"

namespace wobblebench::bench {

namespace {

constexpr double kSnrTolerance = 0.03;
constexpr double kLevelBar_db = 0.5;

/// Probability density of the envelope over its RMS.
Series histogram(const SpeckleRung& variant, const SpeckleResult& result) {
  constexpr int kBins = 40;
  constexpr double kHighest = 3;
  std::vector<double> counts(kBins, 0.0);
  for (const double value : result.values) {
    const int bin = static_cast<int>(value / kHighest * kBins);
    if (bin < kBins) ++counts[static_cast<std::size_t>(bin)];
  }
  Series series{variant.name, {}, {}, Stroke::none, variant.mark};
  for (int bin = 0; bin < kBins; ++bin) {
    const double share =
        counts[static_cast<std::size_t>(bin)] / static_cast<double>(result.values.size());
    series.x.push_back((bin + 0.5) * kHighest / kBins);
    series.y.push_back(share * kBins / kHighest);
  }
  return series;
}

Series rayleigh_density() {
  Series series{"Rayleigh"};
  series.colour = 6;
  for (int i = 0; i <= 120; ++i) {
    const double x = 0.025 * i;
    series.x.push_back(x);
    series.y.push_back(2 * x * std::exp(-x * x));
  }
  return series;
}

void add_checks(const std::string& name,
                const SpeckleInputs& inputs,
                const SpeckleResult& result,
                StudyReport& report) {
  report.checks.push_back({name + ".mean_over_sigma",
                           Check::Kind::within,
                           result.envelope.snr(),
                           rayleigh_snr(),
                           kSnrTolerance,
                           "1",
                           "sqrt(pi / (4 - pi)), a Rayleigh envelope (references.md [7])",
                           static_cast<long>(result.values.size()),
                           "samples",
                           inputs.seeds});
  report.checks.push_back(
      worst_level(name + ".level", result.levels, kLevelBar_db, {"depths", inputs.seeds}));
}

void add_distances(const std::string& series,
                   const SpeckleInputs& inputs,
                   const SpeckleResult& result,
                   StudyReport& report) {
  for (std::size_t i = 0; i < inputs.seeds.size(); ++i) {
    const auto& seed = result.seeds[i];
    report.points.push_back({series + " Kolmogorov-Smirnov distance",
                             "seed",
                             static_cast<double>(inputs.seeds[i]),
                             "distance",
                             seed.distance,
                             rayleigh_critical_distance(static_cast<double>(seed.n))});
  }
}

void add_row(const std::string& series, const SpeckleResult& result, std::ostream& table) {
  double distance = 0;
  for (const auto& seed : result.seeds) distance = std::max(distance, seed.distance);
  table << "| " << series << " | " << fixed(result.envelope.snr(), 3) << " | " << fixed(distance, 4)
        << " | "
        << fixed(rayleigh_critical_distance(static_cast<double>(result.seeds.front().n)), 4)
        << " | " << result.rejected() << " of " << result.seeds.size() << " |\n";
}

std::string introduction(const SpeckleInputs& inputs) {
  std::ostringstream text;
  text
      << "Soft tissue without losses, three lines and 80 frames about the middle of the sector "
         "(axis) and about its last stick (edge), "
      << 1e3 * inputs.from_m << " to " << 1e3 * inputs.to_m
      << " mm from the face, one sample in every " << 1e3 * inputs.step_m
      << " mm: about as far apart as speckle is wide. The density of scatterers is the default, "
      << inputs.scatterers_per_cell
      << " in a resolution cell. Each envelope is divided by the root mean square of its line and "
         "10 "
         "mm of range. Level: mean power at the depths of `tests/yardstick/speckle.csv`, over that "
         "of the material, against the table's over its middle stick at the same range.\n\n"
         "Kolmogorov-Smirnov distances are stated, not checked: with N scatterers in the beam's "
         "effective volume the distribution departs from Rayleigh's by 0.115/N (the first term of "
         "its Laguerre series), so that enough samples tell any density from it. Critical "
         "distances "
         "at 1 % are those of an exponential of unknown mean (the envelope's square), Stephens, J. "
         "Am. Stat. Assoc. 69, 730 (1974).\n\n"
         "| rung, preset, place | mean / sigma | largest distance | critical | seeds beyond it |\n"
         "| --- | ---: | ---: | ---: | ---: |\n";
  return text.str();
}

/// Where the results of a place go.
struct Parts {
  StudyReport report;
  Chart chart;
  std::ostringstream table;
};

void add_place(const SpeckleRung& variant, SpeckleInputs inputs, Parts& parts) {
  inputs.rung = variant.rung;
  inputs.side_lobes = variant.side_lobes;
  const SpeckleResult result = measure_speckle(inputs);
  const std::string rung = variant.name, preset(table_name(inputs.preset));
  const bool axis = inputs.sector_fraction == 0;
  const std::string place = axis ? "axis" : "edge";
  add_checks("speckle." + rung + "." + preset + "." + place, inputs, result, parts.report);
  add_distances(rung + " " + preset + " " + place, inputs, result, parts.report);
  add_points(rung + " " + preset, result.levels, parts.report);
  add_row(rung + ", " + preset + ", " + place, result, parts.table);
  if (inputs.preset != hw::ProbePreset::standard || !axis) return;
  parts.chart.series.push_back(histogram(variant, result));
  parts.chart.series.back().colour = static_cast<int>(parts.chart.series.size()) - 2;
}

}  // namespace

StudyReport speckle_statistics_report() {
  Parts parts;
  parts.report.id = "speckle";
  parts.report.title = "Speckle statistics";
  parts.chart = {"Envelope of speckle", {"envelope / root mean square"}, {"probability density"}};
  parts.chart.series.push_back(rayleigh_density());
  SpeckleInputs inputs;
  for (const hw::ProbePreset preset : kPresets) {
    for (const SpeckleRung& variant : kSpeckleRungs) {
      for (const double fraction : {0.0, 1.0}) {
        inputs.preset = preset;
        inputs.sector_fraction = fraction;
        add_place(variant, inputs, parts);
      }
    }
  }
  parts.report.figures.push_back(
      {"speckle",
       "Histogram of the envelope on Rayleigh's density, standard preset, middle of the sector.",
       draw(parts.chart)});
  parts.report.text = introduction(inputs) + parts.table.str();
  return parts.report;
}

}  // namespace wobblebench::bench
