#include "bench/evaluation/head_pose/facing_surface.h"

#include <cmath>
#include <cstddef>
#include <utility>

#include "render/reconstruction/stick_edges.h"

namespace wobblebench::bench {

namespace {

constexpr double kFluid_m = 10e-3;      // more than a dark spot of tissue
constexpr double kStep_m = 5e-3;        // neighbours on one surface differ by less
constexpr double kLevel = 0.5;          // of the way from fluid to tissue
constexpr double kFluidStep_m = 8e-3;   // between points where there is no tissue
constexpr double kBeforeEdge_m = 4e-3;  // none of these is nearer to a surface

/// The first sample of a stick in the middle of kFluid_m of fluid; `samples`: there is none.
int fluid_begin(const float* stick, int samples, double level, const hw::AcquisitionPlan& plan) {
  const render::WindowMeans means(stick, samples);
  const int window = render::samples_in(render::kEdgeMean_m, plan);
  const int long_enough = render::samples_in(kFluid_m, plan);
  int run = 0;
  for (int k = 0; k < samples; ++k) {
    run = means.mean(k - window / 2, k - window / 2 + window) < level ? run + 1 : 0;
    if (run >= long_enough) return k - long_enough / 2;
  }
  return samples;
}

/// Calls `visit` with the neighbours of a stick.
template <class Visit>
void for_neighbours(int stick, int frames, int lines, const Visit& visit) {
  if (stick >= lines) visit(stick - lines);
  if (stick < (frames - 1) * lines) visit(stick + lines);
  if (stick % lines > 0) visit(stick - 1);
  if (stick % lines < lines - 1) visit(stick + 1);
}

/// The piece of surface that this stick meets. `left`: sticks that belong to none yet.
SurfaceIsland island_at(
    int first, const FacingSurface& seen, int frames, int lines, std::vector<char>& left) {
  const auto edge = [&](int stick) { return seen.edge_m[static_cast<std::size_t>(stick)]; };
  const auto take = [&](int stick) {
    return std::exchange(left[static_cast<std::size_t>(stick)], char{0}) != 0;
  };
  SurfaceIsland island;
  int rim = 0, free = 0;
  std::vector<int> sticks{first};
  take(first);
  for (std::size_t next = 0; next < sticks.size(); ++next) {
    const int here = sticks[next];
    island.points.push_back(seen.sticks[static_cast<std::size_t>(here)].at(edge(here)));
    for_neighbours(here, frames, lines, [&](int beside) {
      if (std::abs(edge(beside) - edge(here)) < kStep_m) {
        if (take(beside)) sticks.push_back(beside);
        return;
      }
      ++rim;
      free += !(edge(beside) < edge(here));
    });
  }
  if (rim > 0) island.free_rim = static_cast<double>(free) / rim;
  return island;
}

}  // namespace

FacingSurface find_facing_surface(const hw::AcquisitionPlan& plan,
                                  const std::vector<hw::PolarFrame>& polar_frames) {
  const int lines = plan.acquisition().sticks_per_frame;
  const int samples = plan.acquisition().samples_per_stick;
  const int frames = static_cast<int>(polar_frames.size());
  const auto count = static_cast<std::size_t>(frames * lines);
  std::vector<std::vector<float>> values;
  FacingSurface found;
  for (const hw::PolarFrame& polar : polar_frames) {
    values.push_back(polar.samples);
    for (int line = 0; line < lines; ++line) {
      found.sticks.push_back(plan.geometry().stick(
          plan.theta_rad(line), polar.motor_angle_rad[static_cast<std::size_t>(line)]));
    }
  }
  std::vector<render::SampleSpan> spans(count, {0, samples});
  const render::EchoLevels levels = render::measure_levels(plan, values, spans);
  for (std::size_t stick = 0; stick < count; ++stick) {
    const auto line = static_cast<std::ptrdiff_t>(stick) % lines;
    const auto& frame = polar_frames[stick / static_cast<std::size_t>(lines)];
    const bool is_lost = frame.arrived[static_cast<std::size_t>(line)] == 0;
    spans[stick].begin =
        is_lost
            ? samples
            : fluid_begin(frame.samples.data() + line * samples, samples, levels.at(kLevel), plan);
  }
  found.edge_m =
      render::find_stick_edges(plan, values, spans, levels, render::EdgeSign::rising, kLevel);
  std::vector<char> left(count, 1);
  const int fluid_step = render::samples_in(kFluidStep_m, plan);
  for (std::size_t stick = 0; stick < count; ++stick) {
    const bool has_edge = !std::isnan(found.edge_m[stick]);
    const double end_m =
        has_edge ? found.edge_m[stick] - kBeforeEdge_m : plan.acquisition().depth_m;
    const int end = static_cast<int>(end_m / plan.sample_spacing_m());
    for (int k = spans[stick].begin; k < end; k += fluid_step) {
      found.fluid.push_back(found.sticks[stick].at(k * plan.sample_spacing_m()));
    }
    if (has_edge && left[stick] != 0) {
      found.islands.push_back(island_at(static_cast<int>(stick), found, frames, lines, left));
    }
  }
  return found;
}

}  // namespace wobblebench::bench
