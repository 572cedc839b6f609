#include "bench/studies/validate/speckle_grid.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <stdexcept>

#include "base/parallel.h"
#include "bench/studies/validate/bodies.h"
#include "bench/studies/validate/preset_plan.h"
#include "bench/studies/validate/scan.h"
#include "sim/optics/pulse_band.h"
#include "sim/speckle/scatterers/scatterer_field.h"
#include "sim/tissue/scanned_tissue.h"
#include "sim/tissue/tissue_map.h"

namespace wobblebench::bench {

namespace {

/// Past the sector's edge, wider than any speckle, so that the scan's end is not seen.
constexpr double kBeyond_rad = 6 * kDegree;
/// Of the plan by which beam tables of `scatterers` are made: no sparser than tables ever are.
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
  const auto tissue = open_tissue();
  const sim::ScannedTissue subject{
      std::make_shared<const sim::TissueMap>(tissue, 1e-3, options.threads),
      tissue.materials(),
      {},
      {}};
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
  const int index = static_cast<int>(std::ceil(range_m / spacing_m - 0.5 - 1e-9));
  return std::clamp(index, 0, samples);
}

std::vector<SpeckleGrid> speckle_grids(hw::ProbePreset preset,
                                       const sim::SimulationOptions& options,
                                       const std::vector<GridPlan>& plans) {
  return options.fidelity == sim::Rung::field ? scanned_grids(preset, options, plans)
                                              : scattered_grids(preset, options, plans);
}

}  // namespace wobblebench::bench
