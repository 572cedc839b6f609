#include "bench/studies/validate/speckle/speckle_grid.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <stdexcept>

#include "base/parallel.h"
#include "base/units.h"
#include "bench/studies/validate/common/scan.h"
#include "bench/studies/validate/common/statistics.h"
#include "sim/optics/probe_optics.h"
#include "sim/optics/pulse_band.h"
#include "sim/speckle/scatterers/scatterer_field.h"
#include "sim/tissue/scanned_tissue.h"
#include "sim/tissue/tissue_map.h"

namespace wobblebench::bench {

namespace {

/// Past the sector's edge, wider than any speckle, so that the scan's end is not seen.
constexpr double kBeyond_rad = 6 * kDegree;
/// Lines of the plan by which beam tables of `scatterers` are made: no sparser than tables ever
/// are.
constexpr int kTableLines = 257, kTableLinesBeyond = 24;

SpeckleGrid empty_grid(const GridPlan& plan) {
  SpeckleGrid grid;
  for (int i = 0; i < plan.lines; ++i) {
    grid.theta_rad.push_back(plan.theta_rad + (i - 0.5 * (plan.lines - 1)) * plan.theta_step_rad);
  }
  grid.frames = plan.frames;
  grid.samples = plan.samples;
  grid.spacing_m = plan.depth_m / plan.samples;
  grid.values.resize(static_cast<std::size_t>(plan.frames * plan.lines * plan.samples));
  return grid;
}

/// One stick of `scatterers`.
void fill_stick(const sim::ScattererField& field,
                const sim::TimedRay& line,
                double spacing_m,
                std::span<float> envelope) {
  std::vector<std::complex<float>> iq(envelope.size());
  const std::vector<float> left(envelope.size(), 1.0f);
  field.add_echoes({line, spacing_m, left, {}}, iq);
  std::ranges::transform(iq, envelope.begin(), [](std::complex<float> z) { return std::abs(z); });
}

SpeckleGrid scattered(const sim::ScattererField& field,
                      const hw::ProbeGeometry& geometry,
                      const GridPlan& plan) {
  SpeckleGrid grid = empty_grid(plan);
  const auto samples = static_cast<std::size_t>(plan.samples);
  parallel_rows(plan.frames * plan.lines, [&](int i) {
    const double theta = grid.theta_rad[static_cast<std::size_t>(i % plan.lines)];
    const int frame = i / plan.lines;
    const double phi = (frame - 0.5 * (plan.frames - 1)) * plan.phi_step_rad;
    fill_stick(field,
               {geometry.stick(theta, phi), 0},
               grid.spacing_m,
               std::span(grid.values).subspan(static_cast<std::size_t>(i) * samples, samples));
  });
  return grid;
}

std::vector<SpeckleGrid> scattered_grids(hw::ProbePreset preset,
                                         const sim::SimulationOptions& options,
                                         const std::vector<GridPlan>& plans) {
  const GridPlan& first = plans.front();
  const hw::AcquisitionPlan plan = preset_plan(preset,
                                               {.depth_m = first.depth_m,
                                                .sticks_per_frame = kTableLines,
                                                .samples_per_stick = first.samples,
                                                .frames_per_volume = 1},
                                               kTableLinesBeyond);
  if (sim::iq_oversampling(plan) != 1) throw std::invalid_argument("speckle_grids: coarse samples");
  const auto subject = scanned(open_tissue(), options.threads);
  const sim::ScattererField field(subject, sim::ProbeOptics(plan, options), options);
  std::vector<SpeckleGrid> grids;
  for (const GridPlan& one : plans) grids.push_back(scattered(field, plan.geometry(), one));
  return grids;
}

SpeckleGrid taken_from(const Scan& volume, const GridPlan& plan) {
  const double offset = (plan.theta_rad - volume.plan.theta_rad(0)) / plan.theta_step_rad;
  const int first = static_cast<int>(std::lround(offset - 0.5 * (plan.lines - 1)));
  GridPlan here = plan;
  here.theta_rad = volume.plan.theta_rad(first) + 0.5 * (plan.lines - 1) * plan.theta_step_rad;
  SpeckleGrid grid = empty_grid(here);
  auto to = grid.values.begin();
  const auto samples = static_cast<std::ptrdiff_t>(plan.samples);
  const int lines = volume.plan.acquisition().sticks_per_frame;
  for (int f = 0; f < plan.frames; ++f) {
    for (int l = first; l < first + plan.lines; ++l) {
      to = std::copy_n(volume.samples.begin() + (f * lines + l) * samples, samples, to);
    }
  }
  return grid;
}

std::vector<SpeckleGrid> scanned_grids(hw::ProbePreset preset,
                                       const sim::SimulationOptions& options,
                                       const std::vector<GridPlan>& plans) {
  const GridPlan& first = plans.front();
  const double half_rad = 0.5 * hw::probe_preset(preset).sector_rad + kBeyond_rad;
  const int lines = 1 + 2 * static_cast<int>(std::ceil(half_rad / first.theta_step_rad));
  const hw::AcquisitionPlan plan(hw::probe_preset(preset).probe,
                                 {.depth_m = first.depth_m,
                                  .sector_rad = (lines - 1) * first.theta_step_rad,
                                  .fan_rad = (first.frames - 1) * first.phi_step_rad,
                                  .sticks_per_frame = lines,
                                  .samples_per_stick = first.samples,
                                  .frames_per_volume = first.frames});
  const Scan volume = scan({open_tissue()}, plan, options);
  std::vector<SpeckleGrid> grids;
  for (const GridPlan& one : plans) grids.push_back(taken_from(volume, one));
  return grids;
}

}  // namespace

int SpeckleGrid::sample_at(double range_m) const {
  return first_sample_at(range_m, spacing_m, samples);
}

std::vector<SpeckleGrid> speckle_grids(hw::ProbePreset preset,
                                       const sim::SimulationOptions& options,
                                       const std::vector<GridPlan>& plans) {
  return options.fidelity == sim::Rung::field ? scanned_grids(preset, options, plans)
                                              : scattered_grids(preset, options, plans);
}

namespace {

/// Near the array's end the level falls by some dB a degree.
constexpr double kMiddle_rad = 0.3 * kDegree;

/// From the grid's middle to the middle of two lines.
double away_rad(const SpeckleGrid& grid, int line, int other) {
  const auto theta = [&](int i) { return grid.theta_rad[static_cast<std::size_t>(i)]; };
  return 0.5 * std::abs(theta(line) + theta(other) - theta(0) - theta(grid.lines() - 1));
}

double intensity(const SpeckleGrid& grid, int frame, int line, int sample) {
  const double amplitude = grid.at(frame, line, sample);
  return amplitude * amplitude;
}

}  // namespace

double intensity_correlation(const SpeckleGrid& grid,
                             const ScanWindow& window,
                             const ScanStep& step) {
  const int first = grid.sample_at(window.from_m), last = grid.sample_at(window.to_m);
  double covariance = 0, norm = 0;
  for (int line = 0; line + step.lines < grid.lines(); ++line) {
    if (away_rad(grid, line, line + step.lines) >= window.about_middle_rad) continue;
    Moments here, there;
    double products = 0;
    for (int f = 0; f + step.frames < grid.frames; ++f) {
      for (int k = first; k + step.samples < last; ++k) {
        const double x = intensity(grid, f, line, k);
        const double y = intensity(grid, f + step.frames, line + step.lines, k + step.samples);
        here.add(x);
        there.add(y);
        products += x * y;
      }
    }
    covariance += products / here.count - here.mean() * there.mean();
    norm += here.sigma() * there.sigma();
  }
  return covariance / norm;
}

double mean_intensity(const SpeckleGrid& grid, const ScanWindow& window) {
  const int first = grid.sample_at(window.from_m), last = grid.sample_at(window.to_m);
  Moments all;
  for (int line = 0; line < grid.lines(); ++line) {
    if (away_rad(grid, line, line) > kMiddle_rad) continue;
    for (int f = 0; f < grid.frames; ++f) {
      for (int k = first; k < last; ++k) all.add(intensity(grid, f, line, k));
    }
  }
  return all.mean();
}

double autocovariance_fwhm_m(const std::vector<double>& values, double lag_m) {
  double before = 0;  // minus the logarithm of the value at lag i
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double here = -std::log(std::max(values[i], 1e-3));
    if (here >= std::log(2.0)) {
      const double share = (std::log(2.0) - before) / (here - before);
      const double low = static_cast<double>(i), high = low + 1;
      return 2 * lag_m * std::sqrt(low * low + share * (high * high - low * low));
    }
    before = here;
  }
  throw std::runtime_error("speckle size: the autocovariance does not fall to half");
}

}  // namespace wobblebench::bench
