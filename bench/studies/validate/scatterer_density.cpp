#include "bench/studies/validate/scatterer_density.h"

#include <algorithm>
#include <cmath>

#include "sim/beam/beam_profile.h"

namespace wobblebench::bench {

namespace {

double cell_m3(const hw::AcquisitionPlan& plan, double range_m) {
  return sim::BeamProfile(plan, {}).resolution_cell_m3(range_m);
}

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

double effective_scatterers(const DensityInputs& inputs, double per_cell) {
  const hw::AcquisitionPlan plan({}, inputs.speckle.acquisition);
  double smallest = HUGE_VAL;
  for (int k = 0; k < inputs.speckle.acquisition.samples_per_stick; ++k) {
    smallest = std::min(smallest, cell_m3(plan, plan.sample_range_m(k)));
  }
  const double per_fwhm = std::pow(std::sqrt(2 * kPi) / 2.354820, 3);
  const int count = 1 + static_cast<int>((inputs.speckle.to_m - inputs.speckle.from_m) / 1e-3);
  double sum = 0;
  for (int i = 0; i < count; ++i) {
    // Averages 1 / N, in which the statistics are linear.
    sum += smallest / cell_m3(plan, inputs.speckle.from_m + 1e-3 * i);
  }
  return per_cell * per_fwhm * count / sum;
}

std::vector<DensityPoint> measure_density(const DensityInputs& inputs) {
  std::vector<DensityPoint> found;
  for (const double per_cell : inputs.per_cell) {
    SpeckleInputs speckle = inputs.speckle;
    speckle.scatterers_per_cell = per_cell;
    const SpeckleResult result = measure_speckle(sim::Rung::scatterers, speckle);
    found.push_back({per_cell,
                     effective_scatterers(inputs, per_cell),
                     result.envelope.snr(),
                     snr_of_groups(result.values, 1).error,
                     result.intensity.snr(),
                     snr_of_groups(result.values, 2).error,
                     static_cast<long>(result.values.size())});
  }
  return found;
}

}  // namespace wobblebench::bench
