#include <algorithm>
#include <cmath>
#include <sstream>

#include "bench/report/validation/study_reports.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

constexpr double kSnrTolerance = 0.02;
constexpr double kMeanTolerance = 0.02;
constexpr int kMostRejected = 1;

/// Probability density of the envelope over its RMS.
Series histogram(const std::string& name, const SpeckleResult& result) {
  constexpr int kBins = 40;
  constexpr double kHighest = 3;
  const double rms = std::sqrt(result.envelope.mean_square());
  std::vector<double> counts(kBins, 0.0);
  for (const double value : result.values) {
    const int bin = static_cast<int>(value / rms / kHighest * kBins);
    if (bin < kBins) ++counts[static_cast<std::size_t>(bin)];
  }
  Series series{name, {}, {}, Stroke::none, Mark::disc};
  for (int bin = 0; bin < kBins; ++bin) {
    const double density = counts[static_cast<std::size_t>(bin)] /
                           static_cast<double>(result.values.size()) * kBins / kHighest;
    series.x.push_back((bin + 0.5) * kHighest / kBins);
    series.y.push_back(density);
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

void add_checks(const std::string& rung,
                const SpeckleInputs& inputs,
                const SpeckleResult& result,
                StudyReport& report) {
  const long n = static_cast<long>(result.values.size());
  const std::string name = "speckle." + rung;
  const std::string samples = "independent samples";
  report.checks.push_back({name + ".mean_over_sigma",
                           Check::Kind::within,
                           result.envelope.snr(),
                           rayleigh_snr(),
                           kSnrTolerance,
                           "1",
                           "sqrt(pi / (4 - pi)), a Rayleigh envelope (references.md [7])",
                           n,
                           samples,
                           inputs.seeds});
  const auto& first = result.seeds.front();
  report.checks.push_back({name + ".kolmogorov_smirnov",
                           Check::Kind::at_most,
                           first.distance,
                           rayleigh_critical_distance(static_cast<double>(first.n)),
                           0,
                           "1",
                           "critical distance at 1 % with estimated scale (Stephens 1974)",
                           first.n,
                           samples,
                           {inputs.seeds.front()}});
  report.checks.push_back({name + ".kolmogorov_smirnov_rejections",
                           Check::Kind::at_most,
                           static_cast<double>(result.rejected()),
                           kMostRejected,
                           0,
                           "seeds",
                           "more in 0.4 % of cases, were every one of 10 seeds Rayleigh",
                           static_cast<long>(inputs.seeds.size()),
                           "seeds",
                           inputs.seeds});
  report.checks.push_back({name + ".mean_echo",
                           Check::Kind::within,
                           result.envelope.mean(),
                           1,
                           kMeanTolerance,
                           "of the material's",
                           "backscatter_db of soft_tissue",
                           n,
                           samples,
                           inputs.seeds});
}

}  // namespace

StudyReport speckle_statistics_report(const SpeckleInputs& inputs) {
  StudyReport report;
  report.id = "speckle";
  report.title = "Speckle statistics";
  Chart chart{"Envelope of speckle", {"envelope / root mean square"}, {"probability density"}};
  chart.series.push_back(rayleigh_density());
  for (const sim::Rung rung : {sim::Rung::field, sim::Rung::scatterers}) {
    const std::string name = sim::to_string(rung);
    const SpeckleResult result = measure_speckle(rung, inputs);
    add_checks(name, inputs, result, report);
    chart.series.push_back(histogram(name, result));
    chart.series.back().colour = static_cast<int>(chart.series.size()) - 2;
    if (rung == sim::Rung::scatterers) chart.series.back().mark = Mark::ring;
    for (std::size_t i = 0; i < inputs.seeds.size(); ++i) {
      const auto& seed = result.seeds[i];
      report.points.push_back({name + " Kolmogorov-Smirnov distance",
                               "seed",
                               static_cast<double>(inputs.seeds[i]),
                               "distance",
                               seed.distance,
                               rayleigh_critical_distance(static_cast<double>(seed.n))});
    }
    const Series& bins = chart.series.back();
    for (std::size_t i = 0; i < bins.x.size(); ++i) {
      const double x = bins.x[i];
      report.points.push_back({name + " density",
                               "envelope_over_rms",
                               x,
                               "density",
                               bins.y[i],
                               2 * x * std::exp(-x * x)});
    }
  }
  report.figures.push_back(
      {"speckle", "Histogram of the envelope, all seeds, on Rayleigh's density.", draw(chart)});
  std::ostringstream text;
  text << "Tissue without losses, seen by " << inputs.acquisition.sticks_per_frame << " x "
       << inputs.acquisition.frames_per_volume << " sticks, " << 1e3 * inputs.from_m << " to "
       << 1e3 * inputs.to_m << " mm from the face, one sample in every " << 1e3 * inputs.step_m
       << " mm: sticks and samples are farther apart than the point spread is wide, so that "
          "samples are independent. Linear envelope without low-pass and noise; "
       << inputs.scatterers_per_cell
       << " scatterers in the smallest resolution cell. The scale of Rayleigh's distribution is "
          "taken from the same samples, for which Kolmogorov's own table would be too lenient: "
          "critical distances are those of an exponential of unknown mean (the envelope's square), "
          "Stephens, J. Am. Stat. Assoc. 69, 730 (1974).\n\n"
          "A finite number of scatterers is not quite Rayleigh: with N in the beam's effective "
          "volume the distribution departs by 0.115/N (the first term of its Laguerre series), so "
          "that any density is told from Rayleigh by enough samples.";
  report.text = text.str();
  return report;
}

}  // namespace wobblebench::bench
