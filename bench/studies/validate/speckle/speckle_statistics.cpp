#include "bench/studies/validate/speckle/speckle_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "base/units.h"
#include "bench/studies/validate/common/scan.h"
#include "bench/studies/validate/common/study_report.h"
#include "bench/studies/validate/speckle/speckle_grid.h"
#include "phantoms/material.h"

namespace wobblebench::bench {

namespace {

/// Windows over which the mean power is taken that envelopes are divided by.
constexpr double kWindow_m = 10e-3;
constexpr double kHalfLevelWindow_m = 2.5e-3;

GridPlan grid_plan(const SpeckleInputs& inputs) {
  const double half_rad = 0.5 * hw::probe_preset(inputs.preset).sector_rad;
  // 1500 samples: IQ samples then need no oversampling.
  return {inputs.sector_fraction * half_rad, 3, 1.2 * kDegree, 80, 1.25 * kDegree, 0.165, 1500};
}

/// Envelopes of one line within a window of range, every `step` samples, over their root mean
/// square.
void add_line(const SpeckleGrid& grid,
              int line,
              const ScanWindow& window,
              int step,
              std::vector<double>& envelopes) {
  const auto before = static_cast<std::ptrdiff_t>(envelopes.size());
  Moments moments;
  const int last = grid.sample_at(window.to_m);
  for (int f = 0; f < grid.frames; ++f) {
    for (int k = grid.sample_at(window.from_m); k < last; k += step) {
      envelopes.push_back(grid.at(f, line, k));
      moments.add(envelopes.back());
    }
  }
  const double rms = std::sqrt(moments.mean_square());
  std::for_each(envelopes.begin() + before, envelopes.end(), [&](double& value) { value /= rms; });
}

std::vector<double> envelopes_of(const SpeckleGrid& grid, const SpeckleInputs& inputs) {
  const int step = std::max(1, static_cast<int>(std::ceil(inputs.step_m / grid.spacing_m)));
  std::vector<double> envelopes;
  for (int line = 0; line < grid.lines(); ++line) {
    const int windows =
        static_cast<int>(std::ceil((inputs.to_m - inputs.from_m - 1e-6) / kWindow_m));
    for (int window = 0; window < windows; ++window) {
      const double from_m = inputs.from_m + window * kWindow_m;
      const double to_m = std::min(from_m + kWindow_m, inputs.to_m);
      add_line(grid, line, {from_m, to_m}, step, envelopes);
    }
  }
  return envelopes;
}

/// Widths are left NaN.
BeamComparison level_at(const BeamRow& place, const std::vector<SpeckleGrid>& grids) {
  Moments powers;
  for (const SpeckleGrid& grid : grids) {
    powers.add(mean_intensity(
        grid, {place.range_m - kHalfLevelWindow_m, place.range_m + kHalfLevelWindow_m}));
  }
  BeamRow found = place;
  found.lateral_m = found.elevation_m = found.axial_m = std::numeric_limits<double>::quiet_NaN();
  found.level_db = level_over_material_db(powers.mean());
  return {place, found};
}

}  // namespace

double rayleigh_snr() {
  return std::sqrt(kPi / (4 - kPi));
}

double level_over_material_db(double power) {
  return 10 * std::log10(power * kPi / 4) - phantoms::material("soft_tissue").backscatter_db;
}

int SpeckleResult::rejected() const {
  return static_cast<int>(std::count_if(seeds.begin(), seeds.end(), [](const Seed& seed) {
    return seed.distance > rayleigh_critical_distance(static_cast<double>(seed.n));
  }));
}

SpeckleResult measure_speckle(const SpeckleInputs& inputs) {
  SpeckleResult result;
  std::vector<SpeckleGrid> grids;
  for (const std::uint64_t seed : inputs.seeds) {
    auto options = lossless_envelope(inputs.rung, seed);
    options.side_lobes = inputs.side_lobes;
    options.scatterers_per_cell = inputs.scatterers_per_cell;
    grids.push_back(speckle_grids(inputs.preset, options, {grid_plan(inputs)}).front());
    std::vector<double> envelope = envelopes_of(grids.back(), inputs);
    for (const double value : envelope) {
      result.envelope.add(value);
      result.intensity.add(value * value);
    }
    result.values.insert(result.values.end(), envelope.begin(), envelope.end());
    const long n = static_cast<long>(envelope.size());
    result.seeds.push_back({rayleigh_distance(std::move(envelope)), n});
  }
  for (const BeamRow& place : speckle_rows(inputs.preset)) {
    const bool here = place.sector_fraction == inputs.sector_fraction &&
                      place.range_m >= inputs.from_m && place.range_m <= inputs.to_m;
    if (here) result.levels.push_back(level_at(place, grids));
  }
  return result;
}

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
    series.add((bin + 0.5) * kHighest / kBins, share * kBins / kHighest);
  }
  return series;
}

Series rayleigh_density() {
  Series series{"Rayleigh"};
  series.colour = 6;
  for (int i = 0; i <= 120; ++i) {
    const double x = 0.025 * i;
    series.add(x, 2 * x * std::exp(-x * x));
  }
  return series;
}

void add_checks(const std::string& name,
                const SpeckleInputs& inputs,
                const SpeckleResult& result,
                StudyReport& report) {
  report.check(name + ".mean_over_sigma")
      .within(result.envelope.snr(), rayleigh_snr(), kSnrTolerance, "1")
      .from("sqrt(pi / (4 - pi)), a Rayleigh envelope (references.md [7])")
      .over(static_cast<long>(result.values.size()), "samples", inputs.seeds);
  report.checks.push_back(
      worst_level(name + ".level", result.levels, kLevelBar_db, {"depths", inputs.seeds}));
}

void add_distances(const std::string& series,
                   const SpeckleInputs& inputs,
                   const SpeckleResult& result,
                   StudyReport& report) {
  for (std::size_t i = 0; i < inputs.seeds.size(); ++i) {
    const auto& seed = result.seeds[i];
    report.point(
        series + " Kolmogorov-Smirnov distance",
        {"seed", static_cast<double>(inputs.seeds[i])},
        {"distance", seed.distance, rayleigh_critical_distance(static_cast<double>(seed.n))});
  }
}

void add_row(const std::string& series, const SpeckleResult& result, Table& table) {
  double distance = 0;
  for (const auto& seed : result.seeds) distance = std::max(distance, seed.distance);
  table.add({series,
             result.envelope.snr(),
             distance,
             rayleigh_critical_distance(static_cast<double>(result.seeds.front().n)),
             std::to_string(result.rejected()) + " of " + std::to_string(result.seeds.size())});
}

std::string introduction(const SpeckleInputs& inputs) {
  std::ostringstream text;
  text << "Soft tissue without losses, three lines and 80 frames about the middle of the sector "
          "(axis) and about its last stick (edge), "
       << 1e3 * inputs.from_m << " to " << 1e3 * inputs.to_m
       << " mm from the face, one sample in every " << 1e3 * inputs.step_m
       << " mm: about as far apart as speckle is wide. The density of scatterers is the default, "
       << inputs.scatterers_per_cell
       << " in a resolution cell. Each envelope is divided by the root mean square of its line and "
          "10 mm of range. Level: mean power at the depths of `tests/yardstick/speckle.csv`, over "
          "that of the material, against the table's over its middle stick at the same range.\n\n"
          "Kolmogorov-Smirnov distances are stated, not checked: with N scatterers in the beam's "
          "effective volume the distribution departs from Rayleigh's by 0.115/N (the first term of "
          "its Laguerre series), so that enough samples tell any density from it. Critical "
          "distances at 1 % are those of an exponential of unknown mean (the envelope's square), "
          "Stephens, J. Am. Stat. Assoc. 69, 730 (1974).";
  return text.str();
}

/// Where the results of a place go.
struct Parts {
  StudyReport report;
  Chart chart;
  Table table = {.name = "speckle",
                 .columns = {{"series", "rung, preset, place"},
                             {"snr", "mean / sigma", "", 3},
                             {"distance", "largest distance", "", 4},
                             {"critical", "critical", "", 4},
                             {"rejected", "seeds beyond it"}}};
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
       {parts.chart}});
  parts.report.text = introduction(inputs);
  parts.report.tables = {parts.table};
  return parts.report;
}

namespace {

/// Mean of mean / sigma over groups of `values`, and its standard error.
struct Grouped {
  double mean = 0;
  double error = 0;
};
Grouped snr_of_groups(const std::vector<double>& values, int power) {
  constexpr std::size_t kGroups = 16;
  Moments groups;
  const std::size_t each = values.size() / kGroups;
  for (std::size_t g = 0; g < kGroups; ++g) {
    Moments moments;
    for (std::size_t i = g * each; i < (g + 1) * each; ++i) {
      moments.add(power == 2 ? values[i] * values[i] : values[i]);
    }
    groups.add(moments.snr());
  }
  return {groups.mean(), groups.sigma() / std::sqrt(static_cast<double>(kGroups - 1))};
}

}  // namespace

double intensity_snr(double effective) {
  return 1 / std::sqrt(1 + 1 / effective);
}

double envelope_snr(double effective) {
  const double shape = 2 * effective;
  const double mean = std::exp(std::lgamma(shape + 0.5) - std::lgamma(shape)) *
                      std::sqrt(kPi / 4 / shape);  // over the root of the mean intensity
  return mean / std::sqrt(1 - mean * mean);
}

double effective_scatterers(double per_cell) {
  return per_cell * std::pow(std::sqrt(2 * kPi) / (2 * std::sqrt(2 * std::log(2.0))), 3);
}

std::vector<DensityPoint> measure_density(const DensityInputs& inputs) {
  std::vector<DensityPoint> found;
  for (const double per_cell : inputs.per_cell) {
    SpeckleInputs speckle = inputs.speckle;
    speckle.scatterers_per_cell = per_cell;
    const SpeckleResult result = measure_speckle(speckle);
    found.push_back({per_cell,
                     effective_scatterers(per_cell),
                     result.envelope.snr(),
                     snr_of_groups(result.values, 1).error,
                     result.intensity.snr(),
                     snr_of_groups(result.values, 2).error,
                     static_cast<long>(result.values.size())});
  }
  return found;
}

namespace {

constexpr double kTolerance = 0.04;  // of the intensity's mean / sigma

Chart make_chart(const std::vector<DensityPoint>& found) {
  Chart chart{"Speckle against scatterers in a resolution cell",
              {"scatterers in a resolution cell", Scale::logarithmic},
              {"mean / sigma"}};
  Series envelope{"envelope", {}, {}, Stroke::none, Mark::disc, 0};
  Series intensity{"intensity", {}, {}, Stroke::none, Mark::square, 1};
  Series k_law{"K distribution", {}, {}, Stroke::solid, Mark::none, 0};
  Series poisson{"1/sqrt(1 + 1/N)", {}, {}, Stroke::solid, Mark::none, 1};
  Series limit{"Rayleigh: 1.913", {}, {}, Stroke::dashed, Mark::none, 6};
  for (const DensityPoint& point : found) {
    const auto add = [&](Series& series, double y) { series.add(point.per_cell, y); };
    add(envelope, point.envelope_snr);
    envelope.low.push_back(point.envelope_snr - 2 * point.envelope_error);
    envelope.high.push_back(point.envelope_snr + 2 * point.envelope_error);
    add(intensity, point.intensity_snr);
    intensity.low.push_back(point.intensity_snr - 2 * point.intensity_error);
    intensity.high.push_back(point.intensity_snr + 2 * point.intensity_error);
    add(k_law, envelope_snr(point.effective));
    add(poisson, intensity_snr(point.effective));
    add(limit, rayleigh_snr());
  }
  chart.series = {k_law, envelope, poisson, intensity, limit};
  chart.y.low = 0.4;
  chart.y.high = 2.05;
  return chart;
}

}  // namespace

StudyReport scatterer_density_report() {
  const DensityInputs inputs;
  StudyReport report;
  const auto found = measure_density(inputs);
  for (const DensityPoint& point : found) {
    report.point("envelope mean / sigma",
                 {"scatterers_per_cell", point.per_cell},
                 {"mean_over_sigma", point.envelope_snr, envelope_snr(point.effective)});
    report.point("intensity mean / sigma",
                 {"scatterers_per_cell", point.per_cell},
                 {"mean_over_sigma", point.intensity_snr, intensity_snr(point.effective)});
  }
  const auto worst = std::max_element(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return std::abs(a.intensity_snr - intensity_snr(a.effective)) <
           std::abs(b.intensity_snr - intensity_snr(b.effective));
  });
  report.check("density.intensity_worst")
      .within(worst->intensity_snr, intensity_snr(worst->effective), kTolerance, "1")
      .from("1 / sqrt(1 + 1/N), N scatterers at Poisson's random, at the density that fits worst")
      .over(worst->n, "independent samples", inputs.speckle.seeds);
  report.check("density.envelope_at_most")
      .within(found.back().envelope_snr, rayleigh_snr(), 0.03, "1")
      .from("the limit of many scatterers, sqrt(pi / (4 - pi))")
      .over(found.back().n, "independent samples", inputs.speckle.seeds);
  report.figures.push_back(
      {"density",
       "Mean over sigma of envelope and intensity; bars are two standard errors.",
       {make_chart(found)}});
  std::ostringstream text;
  text << "The rung `scatterers`, standard preset, middle stick, " << 1e3 * inputs.speckle.from_m
       << " to " << 1e3 * inputs.speckle.to_m
       << " mm from the face. `simulation.scatterers_per_cell` counts scatterers in the product of "
          "the three -6 dB widths; in a Gaussian beam the effective number N in a sample is 1.064 "
          "cubed times that. Intensity follows 1/sqrt(1 + 1/N); the envelope that of a K "
          "distribution with the same (Jakeman and Pusey, IEEE Trans. Antennas Propag. 24, 806 "
          "(1976)).";
  report.text = text.str();
  return report;
}

}  // namespace wobblebench::bench
