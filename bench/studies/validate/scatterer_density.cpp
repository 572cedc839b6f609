#include "bench/studies/validate/scatterer_density.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/units.h"

namespace wobblebench::bench {

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
    const auto add = [&](Series& series, double y) { add_to(series, point.per_cell, y); };
    add(envelope, point.envelope_snr);
    envelope.error.push_back(2 * point.envelope_error);
    add(intensity, point.intensity_snr);
    intensity.error.push_back(2 * point.intensity_error);
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
       draw(make_chart(found))});
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
