#include "bench/studies/validate/speckle_size.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/parallel.h"
#include "base/statistics.h"
#include "bench/studies/validate/autocovariance.h"
#include "bench/studies/validate/scan.h"
#include "bench/studies/validate/speckle_statistics.h"

namespace wobblebench::bench {

namespace {

constexpr double kDepth_m = 0.165;
constexpr int kSamples = 1500;  // IQ samples then need no oversampling
/// Towards the end of the array speckle doubles within some degrees.
constexpr double kAboutStick_rad = 0.3 * kDegree;
/// Lags are measured until the covariance is well below a half.
constexpr double kEnough = 0.4;
constexpr int kMostLags = 60;

/// Sticks about a place: in the dense direction a quarter of the width apart or less, in the others
/// about the width or more.
struct DenseGrid {
  GridPlan plan;
  ScanStep step;
  double about_middle_rad = HUGE_VAL;
};

DenseGrid dense_grid(BeamDirection direction) {
  switch (direction) {
    case BeamDirection::axial:
      return {{0, 3, 1.2 * kDegree, 48, 1.7 * kDegree, kDepth_m, 4096}, {0, 0, 1}};
    case BeamDirection::lateral:
      return {{0, 21, 0.25 * kDegree, 96, 0.85 * kDegree, kDepth_m, kSamples},
              {0, 1, 0},
              kAboutStick_rad};
    case BeamDirection::elevation:
      return {{0, 2, 2.4 * kDegree, 320, 0.19 * kDegree, kDepth_m, kSamples}, {1, 0, 0}};
  }
  throw std::logic_error("BeamDirection: no such direction");
}

/// Between neighbours in the dense direction.
double step_m(BeamDirection direction,
              const GridPlan& plan,
              const hw::ProbeGeometry& geometry,
              const BeamRow& place) {
  const double radius_m = geometry.radius_m() + place.range_m;
  switch (direction) {
    case BeamDirection::axial:
      return plan.depth_m / plan.samples;
    case BeamDirection::lateral:
      return radius_m * plan.theta_step_rad;
    case BeamDirection::elevation:
      return (radius_m * std::cos(place.theta_rad) - geometry.axis_z_m()) * plan.phi_step_rad;
  }
  throw std::logic_error("BeamDirection: no such direction");
}

ScanStep times(const ScanStep& step, int lag) {
  return {step.frames * lag, step.lines * lag, step.samples * lag};
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Standard error of the mean over the mean.
double relative_error(const std::vector<double>& values) {
  double squares = 0;
  for (const double value : values) squares += (value - mean(values)) * (value - mean(values));
  const double n = static_cast<double>(values.size());
  return std::sqrt(squares / (n - 1) / n) / mean(values);
}

/// Of one seed: the covariance at lags 1, 2, ... until it is low.
std::vector<double> covariances(const SpeckleGrid& grid,
                                const ScanWindow& window,
                                const ScanStep& step) {
  std::vector<double> values;
  for (int lag = 1; lag <= kMostLags && (values.empty() || values.back() > kEnough); ++lag) {
    values.push_back(intensity_correlation(grid, window, times(step, lag)));
  }
  return values;
}

SpeckleWidth width_at(const ScanWindow& window,
                      const ScanStep& step,
                      double lag_m,
                      const std::vector<const SpeckleGrid*>& grids) {
  std::vector<double> widths, powers;
  for (const SpeckleGrid* grid : grids) {
    widths.push_back(autocovariance_fwhm_m(covariances(*grid, window, step), lag_m));
    powers.push_back(mean_intensity(*grid, window));
  }
  return {mean(widths), level_over_material_db(mean(powers)), relative_error(widths)};
}

double root_mean_square(const std::vector<SpeckleWidth>& widths) {
  std::vector<double> errors;
  for (const SpeckleWidth& width : widths) errors.push_back(width.relative_error);
  return wobblebench::root_mean_square(errors);
}

}  // namespace

std::vector<SpeckleWidth> measure_speckle_widths(BeamDirection direction,
                                                 const SpeckleSizeInputs& inputs,
                                                 std::span<const BeamRow> places) {
  const DenseGrid dense = dense_grid(direction);
  const hw::ProbeGeometry geometry(hw::probe_preset(inputs.preset).probe);
  std::vector<GridPlan> plans;  // one for each angle
  std::vector<std::size_t> plan_of;
  for (const BeamRow& place : places) {
    if (plans.empty() || plans.back().theta_rad != place.theta_rad) {
      plans.push_back(dense.plan);
      plans.back().theta_rad = place.theta_rad;
    }
    plan_of.push_back(plans.size() - 1);
  }
  std::vector<std::vector<SpeckleGrid>> grids;  // [seed][angle]
  for (const std::uint64_t seed : inputs.seeds) {
    auto options = lossless_envelope(inputs.rung, seed);
    options.side_lobes = inputs.side_lobes;
    grids.push_back(speckle_grids(inputs.preset, options, plans));
  }
  std::vector<SpeckleWidth> found(places.size());
  parallel_rows(static_cast<int>(places.size()), [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    std::vector<const SpeckleGrid*> of_seeds;
    for (const auto& of_seed : grids) of_seeds.push_back(&of_seed[plan_of[at]]);
    const double range_m = places[at].range_m, half_m = inputs.half_window_m;
    found[at] = width_at({range_m - half_m, range_m + half_m, dense.about_middle_rad},
                         dense.step,
                         step_m(direction, dense.plan, geometry, places[at]),
                         of_seeds);
  });
  return found;
}

SpeckleSize measure_speckle_size(const SpeckleSizeInputs& inputs, std::span<const BeamRow> places) {
  const auto lateral = measure_speckle_widths(BeamDirection::lateral, inputs, places);
  const auto elevation = measure_speckle_widths(BeamDirection::elevation, inputs, places);
  const auto axial = measure_speckle_widths(BeamDirection::axial, inputs, places);
  SpeckleSize size;
  for (std::size_t i = 0; i < places.size(); ++i) {
    BeamRow found = places[i];
    found.lateral_m = lateral[i].fwhm_m;
    found.elevation_m = elevation[i].fwhm_m;
    found.axial_m = axial[i].fwhm_m;
    found.level_db = lateral[i].level_db;
    size.places.push_back({places[i], found});
  }
  size.relative_error[0] = root_mean_square(lateral);
  size.relative_error[1] = root_mean_square(elevation);
  size.relative_error[2] = root_mean_square(axial);
  return size;
}

}  // namespace wobblebench::bench
