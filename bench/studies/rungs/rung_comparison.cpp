#include "bench/studies/rungs/rung_comparison.h"

#include <algorithm>
#include <cmath>

#include "bench/studies/validate/bodies.h"
#include "bench/studies/validate/scan.h"

namespace wobblebench::bench {

namespace {

/// Estimates of docs/architecture.md.
constexpr double kFieldFloor_ms = 10, kFieldSamples = 1.21e6;
constexpr double kScattererFloor_ms = 200, kScatterers = 47e6;

}  // namespace

const std::vector<sim::Rung>& volume_rungs() {
  static const std::vector<sim::Rung> rungs = {
      sim::Rung::geometry, sim::Rung::field, sim::Rung::scatterers};
  return rungs;
}

RungScene small_sheet(const sim::SimulationOptions& options) {
  constexpr double kRange_m = 75e-3, kHalf_m = 1e-3;
  const hw::AcquisitionPlan plan({},
                                 {.depth_m = 0.078,
                                  .sector_rad = 4 * kDegree,
                                  .sticks_per_frame = 4,
                                  .samples_per_stick = 256,
                                  .frames_per_volume = 1});
  return {phantoms::still_at(block({4e-3, 4e-3, kHalf_m}, 0.5e-3),
                             {0, 0, plan.probe().radius_m + kRange_m}),
          plan,
          options};
}

double floor_ms(sim::Rung rung, const RungsResults& results) {
  if (rung == sim::Rung::field) return kFieldFloor_ms * results.samples / kFieldSamples;
  for (const StageTimes& stages : results.stages) {
    if (stages.rung != rung || stages.scatterers == 0) continue;
    return kScattererFloor_ms * static_cast<double>(stages.scatterers) / kScatterers;
  }
  return 0;
}

Image<float> frame_picture(const hw::AcquisitionPlan& plan,
                           const std::vector<float>& volume,
                           int frame,
                           int width) {
  const auto& a = plan.acquisition();
  const double radius_m = plan.probe().radius_m, reach_m = radius_m + a.depth_m;
  const double half_m = reach_m * std::sin(0.5 * a.sector_rad);
  const double top_m = radius_m * std::cos(0.5 * a.sector_rad);
  const int height = static_cast<int>(width * (reach_m - top_m) / (2 * half_m));
  Image<float> picture(width, height, 1.0f);
  const float* frame_begin = volume.data() + static_cast<std::size_t>(frame) *
                                                 static_cast<std::size_t>(a.sticks_per_frame) *
                                                 static_cast<std::size_t>(a.samples_per_stick);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const double x = half_m * ((column + 0.5) / width * 2 - 1);
      const double z = top_m + (reach_m - top_m) * (row + 0.5) / height;
      const double k = (std::hypot(x, z) - radius_m) / plan.sample_spacing_m() - 0.5;
      const double l = (std::atan2(x, z) - plan.theta_rad(0)) / plan.theta_step_rad();
      if (k < 0 || l < 0 || k > a.samples_per_stick - 1 || l > a.sticks_per_frame - 1) continue;
      const int k0 = std::min(static_cast<int>(k), a.samples_per_stick - 2);
      const int l0 = std::min(static_cast<int>(l), a.sticks_per_frame - 2);
      const float u = static_cast<float>(k - k0), v = static_cast<float>(l - l0);
      const float* stick = frame_begin + static_cast<std::ptrdiff_t>(l0) * a.samples_per_stick + k0;
      const float* next = stick + a.samples_per_stick;
      picture.at(column, row) = (1 - v) * (stick[0] + u * (stick[1] - stick[0])) +
                                v * (next[0] + u * (next[1] - next[0]));
    }
  }
  return picture;
}

}  // namespace wobblebench::bench
