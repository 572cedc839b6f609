#include "bench/evaluation/head_pose/facing_surface.h"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "render/reconstruction/stick_edges.h"

namespace wobblebench::bench {

namespace {

constexpr double kFluid_m = 10e-3;  // more than a dark spot of tissue
constexpr double kStep_m = 5e-3;    // neighbours on one surface differ by less
constexpr double kLevel = 0.5;      // of the way from fluid to tissue

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

/// Calls `visit` with each neighbour's index; -1: outside the scan.
template <class Visit>
void for_neighbours(int stick, int frames, int lines, const Visit& visit) {
  const int frame = stick / lines, line = stick % lines;
  for (const auto& [df, dl] :
       std::array<std::pair<int, int>, 4>{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}}) {
    const int f = frame + df, l = line + dl;
    visit(f < 0 || l < 0 || f >= frames || l >= lines ? -1 : f * lines + l);
  }
}

std::vector<SurfaceIsland> islands_of(const std::vector<double>& edge_m, int frames, int lines) {
  const auto edge = [&](int stick) { return edge_m[static_cast<std::size_t>(stick)]; };
  std::vector<SurfaceIsland> islands;
  std::vector<char> taken(edge_m.size());
  for (int first = 0; first < frames * lines; ++first) {
    if (std::isnan(edge(first)) || taken[static_cast<std::size_t>(first)]) continue;
    SurfaceIsland island{.sticks = {static_cast<std::size_t>(first)}};
    taken[static_cast<std::size_t>(first)] = 1;
    int rim = 0, free = 0;
    for (std::size_t next = 0; next < island.sticks.size(); ++next) {
      const int here = static_cast<int>(island.sticks[next]);
      for_neighbours(here, frames, lines, [&](int beside) {
        if (beside < 0) return;
        if (std::abs(edge(beside) - edge(here)) < kStep_m) {
          if (std::exchange(taken[static_cast<std::size_t>(beside)], 1) == 0) {
            island.sticks.push_back(static_cast<std::size_t>(beside));
          }
          return;
        }
        ++rim;
        free += !(edge(beside) < edge(here));
      });
    }
    island.free_rim = rim > 0 ? double(free) / rim : 0;
    islands.push_back(std::move(island));
  }
  return islands;
}

}  // namespace

FacingSurface find_facing_surface(const hw::PolarVolume& volume) {
  const hw::AcquisitionPlan& plan = volume.plan();
  const int lines = plan.acquisition().sticks_per_frame;
  const int samples = plan.acquisition().samples_per_stick;
  const int frames = static_cast<int>(volume.frames().size());
  const auto count = static_cast<std::size_t>(frames * lines);
  std::vector<std::vector<float>> values;
  FacingSurface found;
  for (int frame = 0; frame < frames; ++frame) {
    const hw::PolarFrame& polar = volume.frame(frame);
    values.push_back(polar.samples);
    for (int line = 0; line < lines; ++line) {
      found.sticks.push_back(plan.geometry().stick(
          plan.theta_rad(line), polar.motor_angle_rad[static_cast<std::size_t>(line)]));
    }
  }
  std::vector<render::SampleSpan> spans(count, {0, samples});
  const render::EchoLevels levels = render::measure_levels(plan, values, spans);
  found.fluid_m.assign(count, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t stick = 0; stick < count; ++stick) {
    const auto line = static_cast<std::ptrdiff_t>(stick) % lines;
    const float* const first =
        values[stick / static_cast<std::size_t>(lines)].data() + line * samples;
    spans[stick].begin = fluid_begin(first, samples, levels.at(kLevel), plan);
    if (spans[stick].begin < samples) {
      found.fluid_m[stick] = spans[stick].begin * plan.sample_spacing_m();
    }
  }
  found.edge_m =
      render::find_stick_edges(plan, values, spans, levels, render::EdgeSign::rising, kLevel);
  found.islands = islands_of(found.edge_m, frames, lines);
  return found;
}

}  // namespace wobblebench::bench
