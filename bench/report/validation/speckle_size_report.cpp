#include <array>
#include <cmath>

#include "bench/report/validation/study_reports.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

constexpr double kTolerance = 0.05;
/// Of `scatterers` without side lobes, and along the stick away from the foci, where its beam's
/// table loses a part of the band.
constexpr double kLooseTolerance = 0.12;

struct Named {
  BeamDirection direction;
  const char* name;
};
constexpr std::array<Named, 3> kDirections = {{{BeamDirection::axial, "axial"},
                                               {BeamDirection::lateral, "lateral"},
                                               {BeamDirection::elevation, "elevation"}}};

struct Variant {
  const char* name;
  const char* title;
  sim::Rung rung;
  bool side_lobes;
  Mark mark;
};
constexpr std::array<Variant, 3> kVariants = {
    {{"field", "field", sim::Rung::field, false, Mark::disc},
     {"scatterers_side_lobes", "with side lobes", sim::Rung::scatterers, true, Mark::ring},
     {"scatterers", "main lobe", sim::Rung::scatterers, false, Mark::triangle}}};

double tolerance(const Variant& variant, BeamDirection direction, double range_m) {
  if (variant.rung == sim::Rung::field) return kTolerance;
  const bool in_focus = std::abs(range_m / hw::ProbeOptions().transmit_focus_m - 1) < 0.1;
  if (direction == BeamDirection::axial) return in_focus ? kTolerance : kLooseTolerance;
  return variant.side_lobes ? kTolerance : kLooseTolerance;
}

std::string whole_mm(double metres) {
  return std::to_string(std::lround(metres * 1e3));
}

void add_result(const std::string& series,
                const Autocorrelation& found,
                const SpeckleSizeInputs& inputs,
                double tolerance,
                StudyReport& report) {
  report.checks.push_back(
      {"speckle_size." + series + "_at_" + whole_mm(found.range_m) + "mm",
       Check::Kind::within,
       found.fwhm_m * 1e3,
       found.expected_m * 1e3,
       tolerance * found.expected_m * 1e3,
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

StudyReport speckle_size_report(const SpeckleSizeInputs& inputs) {
  StudyReport report;
  report.id = "speckle_size";
  report.title = "Size of speckle";
  Chart chart{"Autocovariance of the intensity",
              {"lag / expected full width at half maximum"},
              {"autocovariance / variance"}};
  Series gaussian{"Gaussian"};
  gaussian.colour = 6;
  for (int i = 0; i <= 75; ++i) {
    const double u = 0.02 * i;
    gaussian.x.push_back(u);
    gaussian.y.push_back(std::exp2(-4 * u * u));
  }
  chart.series.push_back(gaussian);
  for (const Variant& variant : kVariants) {
    SpeckleSizeInputs asked = inputs;
    asked.side_lobes = variant.side_lobes;
    int colour = 0;
    for (const Named& direction : kDirections) {
      const auto found = measure_speckle_size(variant.rung, direction.direction, asked);
      for (const Autocorrelation& one : found) {
        add_result(std::string(variant.name) + "." + direction.name,
                   one,
                   inputs,
                   tolerance(variant, direction.direction, one.range_m),
                   report);
      }
      add_series(
          std::string(variant.title) + ", " + direction.name, colour++, variant.mark, found, chart);
    }
  }
  report.figures.push_back({"speckle_size",
                            "Autocovariance of the intensity in three directions at three depths, "
                            "lags over the expected width.",
                            draw(chart, {720, 420})});
  report.text =
      "Even tissue, scanned densely in one direction and sparsely in the others. The normalised "
      "autocovariance of the intensity of circular Gaussian speckle is the squared magnitude of "
      "the point spread's autocorrelation. For the Gaussian point spread of `field` it is as wide, "
      "at half maximum, as the point spread's amplitude. The beam of `scatterers` comes from "
      "rectangular apertures: its expected width is that of the autocorrelation of the apertures' "
      "two-way response (sim/beam/beam_pattern.h) over the pulse's band. With side lobes it has "
      "that width; its main lobe alone, the default, makes speckle up to a tenth smaller, which is "
      "what leaving them out costs.";
  return report;
}

}  // namespace wobblebench::bench
