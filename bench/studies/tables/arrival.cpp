#include <chrono>
#include <numeric>

#include "base/duration.h"
#include "bench/studies/tables/measure.h"
#include "render/renderer.h"

namespace wobblebench::bench {

namespace {

/// Wall time of adding each frame in turn, milliseconds. update() waits until GL is done.
std::vector<double> add_frames(render::Renderer& renderer, const hw::PolarVolume& volume) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> each_ms;
  for (int f = 0; f < static_cast<int>(volume.frames().size()); ++f) {
    const auto start = Clock::now();
    renderer.add_frame(f, volume.frame(f));
    renderer.update();
    each_ms.push_back(to_milliseconds(Clock::now() - start));
  }
  return each_ms;
}

/// Sum over all passes; without reading the picture back.
double picture_ms(render::Renderer& renderer) {
  const auto passes = renderer.render().passes;
  return std::accumulate(passes.begin(), passes.end(), 0.0, [](double sum, const auto& pass) {
    return sum + pass.ms;
  });
}

}  // namespace

Arrival measure_arrival(const hw::PolarVolume& volume,
                        const render::RenderOptions& options,
                        render::GlContext& context,
                        int repeats) {
  render::Renderer renderer(context, volume.plan(), options);
  std::vector<double> frames, volumes, views;
  render::ViewOptions front = options.view, turned = options.view;
  turned.yaw_rad += 10 * kDegree;
  for (int repeat = -1; repeat < repeats; ++repeat) {
    const auto each_ms = add_frames(renderer, volume);
    const double volume_ms = picture_ms(renderer);
    if (repeat < 0) continue;
    frames.insert(frames.end(), each_ms.begin(), each_ms.end());
    volumes.push_back(volume_ms);
    renderer.set_view(turned);
    views.push_back(picture_ms(renderer));
    renderer.set_view(front);
  }
  return {spread_of(frames), spread_of(volumes), spread_of(views)};
}

}  // namespace wobblebench::bench
