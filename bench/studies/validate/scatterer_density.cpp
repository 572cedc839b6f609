#include "bench/studies/validate/scatterer_density.h"

#include <algorithm>
#include <cmath>

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

}  // namespace wobblebench::bench
