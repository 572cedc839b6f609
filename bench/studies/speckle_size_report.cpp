#include <array>
#include <cmath>

#include "bench/studies/speckle_size.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

constexpr double kTolerance = 0.05;

struct Named {
  BeamDirection direction;
  const char* name;
};
constexpr std::array<Named, 3> kDirections = {{{BeamDirection::axial, "axial"},
                                               {BeamDirection::lateral, "lateral"},
                                               {BeamDirection::elevation, "elevation"}}};

std::string whole_mm(double metres) {
  return std::to_string(std::lround(metres * 1e3));
}

void add_result(const std::string& series,
                const Autocorrelation& found,
                const SpeckleSizeInputs& inputs,
                StudyReport& report) {
  report.checks.push_back(
      {"speckle_size." + series + "_at_" + whole_mm(found.range_m) + "mm",
       Check::Kind::within,
       found.fwhm_m * 1e3,
       found.expected_m * 1e3,
       kTolerance * found.expected_m * 1e3,
       "mm",
       "full width at half maximum of the point spread's autocorrelation, squared",
       found.cells,
       "resolution cells",
       inputs.seeds});
  for (std::size_t i = 0; i < found.lag_m.size(); ++i) {
    const double u = 2 * found.lag_m[i] / found.expected_m;
    report.points.push_back({series + " " + whole_mm(found.range_m) + " mm",
                             "lag_mm",
                             found.lag_m[i] * 1e3,
                             "autocovariance",
                             found.value[i],
                             std::exp2(-u * u)});
  }
}

/// All directions and depths on one curve: lags over the expected width.
void add_series(const std::string& name,
                int colour,
                Mark mark,
                const std::vector<Autocorrelation>& found,
                Chart& chart) {
  Series series{name, {}, {}, Stroke::none, mark, colour};
  for (const Autocorrelation& one : found) {
    const std::size_t stride = std::max<std::size_t>(1, one.lag_m.size() / 12);
    for (std::size_t i = 0; i < one.lag_m.size(); i += stride) {
      series.x.push_back(one.lag_m[i] / one.expected_m);
      series.y.push_back(one.value[i]);
    }
  }
  chart.series.push_back(series);
}

}  // namespace

StudyReport speckle_size_study(const SpeckleSizeInputs& inputs) {
  StudyReport report;
  report.id = "speckle_size";
  report.title = "Size of speckle";
  Chart chart{"Autocovariance of the intensity",
              {"lag / expected full width at half maximum"},
              {"autocovariance / variance"}};
  Series gaussian{"Gaussian"};
  gaussian.colour = 6;
  for (double u = 0; u <= 1.5; u += 0.02) {
    gaussian.x.push_back(u);
    gaussian.y.push_back(std::exp2(-4 * u * u));
  }
  chart.series.push_back(gaussian);
  for (const sim::Rung rung : {sim::Rung::field, sim::Rung::scatterers}) {
    int colour = 0;
    for (const Named& direction : kDirections) {
      const auto found = measure_speckle_size(rung, direction.direction, inputs);
      const std::string series = sim::to_string(rung) + "." + direction.name;
      for (const Autocorrelation& one : found) add_result(series, one, inputs, report);
      add_series(sim::to_string(rung) + ", " + direction.name,
                 colour++,
                 rung == sim::Rung::field ? Mark::disc : Mark::ring,
                 found,
                 chart);
    }
  }
  report.figures.push_back({"speckle_size",
                            "Autocovariance of the intensity in three directions at three depths, "
                            "lags over the expected width.",
                            draw(chart, {720, 420})});
  report.text =
      "Even tissue, scanned densely in one direction and sparsely in the others. The normalised "
      "autocovariance of the intensity of circular Gaussian speckle is the squared magnitude of "
      "the "
      "point spread's autocorrelation. For the Gaussian point spread of `field` it is as wide, at "
      "half maximum, as the point spread's amplitude. The beam of `scatterers` comes from "
      "rectangular "
      "apertures: its expected width is that of the autocorrelation of the apertures' two-way "
      "response "
      "(sim/beam_pattern.h) over the pulse's band.";
  return report;
}

}  // namespace wobblebench::bench
