#include "bench/studies/modes/mode_agreement.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "base/units.h"
#include "render/camera.h"
#include "render/renderer.h"

namespace wobblebench::bench {

bool DepthAgreement::same() const {
  return rms_steps <= kMostRmsSteps && changed_percent() <= kMostChangedPercent;
}

DepthAgreement compare_depths(const Image<float>& one, const Image<float>& other, double step_m) {
  if (one.width != other.width || one.height != other.height) {
    throw std::invalid_argument("two pictures of different sizes");
  }
  const auto rms = [](double squares, std::int64_t count) {
    return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0;
  };
  DepthAgreement found;
  double squares = 0, squares_elsewhere = 0;
  for (std::size_t i = 0; i < one.pixels.size(); ++i) {
    ++found.pixels;
    const bool hit = !std::isnan(one.pixels[i]), other_hit = !std::isnan(other.pixels[i]);
    if (hit != other_hit) ++found.one_hit;
    if (!hit || !other_hit) continue;
    ++found.both_hit;
    const double apart = std::abs(double{one.pixels[i]} - double{other.pixels[i]}) / step_m;
    found.worst_steps = std::max(found.worst_steps, apart);
    if (apart > kSameSurfaceSteps) ++found.elsewhere;
    (apart > kSameSurfaceSteps ? squares_elsewhere : squares) += apart * apart;
  }
  found.rms_steps = rms(squares, found.both_hit - found.elsewhere);
  found.rms_all_steps = rms(squares + squares_elsewhere, found.both_hit);
  return found;
}

const std::vector<Direction>& five_directions() {
  static const std::vector<Direction> directions = {
      {"front", 0, 0},
      {"right", kDegree * 40, 0},
      {"left, below", kDegree * -50, kDegree * -35},
      {"above", 0, kDegree * 60},
      {"across", kDegree * 90, 0},
  };
  return directions;
}

std::vector<ModeAgreement> measure_mode_agreement(const std::string& phantom,
                                                  const hw::PolarVolume& volume,
                                                  const render::RenderOptions& options,
                                                  render::GlContext& context,
                                                  const PartDone& done) {
  const auto renderer = [&](render::PipelineMode mode) {
    render::RenderOptions in_mode = options;
    in_mode.pipeline.mode = mode;
    auto made = std::make_unique<render::Renderer>(context, volume.plan(), in_mode);
    made->add_volume(volume);
    return made;
  };
  const auto plain = renderer(render::PipelineMode::plain);
  const auto fast = renderer(render::PipelineMode::fast);
  std::vector<ModeAgreement> found;
  PartCount parts(five_directions().size(), done);
  for (const Direction& direction : five_directions()) {
    render::ViewOptions view = options.view;
    view.yaw_rad = direction.yaw_rad;
    view.pitch_rad = direction.pitch_rad;
    plain->set_view(view);
    fast->set_view(view);
    found.push_back(
        {phantom,
         direction,
         compare_depths(plain->render().depth_m, fast->render().depth_m, render::step_m(options))});
    parts.finish_one();
  }
  return found;
}

}  // namespace wobblebench::bench
