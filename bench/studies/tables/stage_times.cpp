#include "bench/studies/tables/stage_times.h"

#include <chrono>
#include <memory>

#include "base/duration.h"
#include "base/units.h"
#include "render/presets.h"
#include "render/renderer.h"

namespace wobblebench::bench {

namespace {

using Clock = std::chrono::steady_clock;

double since_ms(Clock::time_point start) {
  return to_milliseconds(Clock::now() - start);
}

/// A renderer of one setting, kept for all repeats.
class Staged {
 public:
  Staged(const std::string& settings,
         const render::RenderOptions& options,
         const hw::PolarVolume& volume,
         render::GlContext& context)
      : volume_(volume),
        front_(options.view),
        renderer_(std::make_unique<render::Renderer>(context, volume.plan(), options)) {
    times_.settings = settings;
    times_.frames = volume.plan().acquisition().frames_per_volume;
  }

  void measure(bool counts) {
    StageTimes before = times_;
    add_frames();
    times_.picture_ms.push_back(picture_ms());
    render::ViewOptions turned = front_;
    turned.yaw_rad += 10 * kDegree;
    renderer_->set_view(turned);
    times_.new_view_ms.push_back(picture_ms());
    renderer_->set_view(front_);
    if (!counts) times_ = std::move(before);
  }

  const StageTimes& times() const { return times_; }

 private:
  void add_frames() {
    for (int frame = 0; frame < times_.frames; ++frame) {
      const auto start = Clock::now();
      renderer_->add_frame(frame, volume_.frame(frame));
      renderer_->update();
      auto& into = frame + 1 < times_.frames ? times_.frame_ms : times_.last_frame_ms;
      into.push_back(since_ms(start));
    }
  }

  double picture_ms() {
    const auto start = Clock::now();
    static_cast<void>(renderer_->render());
    return since_ms(start);
  }

  const hw::PolarVolume& volume_;
  render::ViewOptions front_;
  std::unique_ptr<render::Renderer> renderer_;
  StageTimes times_;
};

}  // namespace

render::RenderOptions paper_settings(const TableRun& run) {
  return settings_of(reference_row(), {}, run.divisor);
}

render::RenderOptions default_settings(const TableRun& run) {
  render::RenderOptions options = render::render_preset(render::RenderPreset::accurate);
  options.scan_conversion.slice_size /= run.divisor;
  options.ray_casting.image_size /= run.divisor;
  return options;
}

std::vector<StageTimes> measure_stages(const TableVolumes& volumes,
                                       render::GlContext& context,
                                       const TableRun& run) {
  std::vector<Staged> all;
  const auto counts = frame_counts();
  for (const int frames : {counts.back(), counts.front()}) {
    const hw::PolarVolume& volume = volumes.by_frames.at(frames);
    all.emplace_back("paper", paper_settings(run), volume, context);
    all.emplace_back("default", default_settings(run), volume, context);
  }
  for (int repeat = -1; repeat < run.repeats; ++repeat) {
    for (Staged& staged : all) staged.measure(repeat >= 0);
  }
  std::vector<StageTimes> times;
  for (const Staged& staged : all) times.push_back(staged.times());
  return times;
}

}  // namespace wobblebench::bench
