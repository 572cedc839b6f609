#include "bench/studies/validate/speckle_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/units.h"
#include "bench/studies/validate/autocovariance.h"
#include "bench/studies/validate/scan.h"
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

}  // namespace wobblebench::bench
