#include "bench/live/live_renderer.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "bench/command/program.h"

namespace wobblebench::bench {

namespace {

/// After a coarse picture, before a software driver takes all cores again: until it is encoded,
/// sent and drawn by a browser on the same machine.
constexpr std::chrono::milliseconds kUntilDrawn{40};

bool is_here(const hw::PolarFrame& frame) {
  return !frame.samples.empty();
}

void add_all(const std::vector<hw::PolarFrame>& frames, render::Renderer& to) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (is_here(frames[i])) to.add_frame(static_cast<int>(i), frames[i]);
  }
  to.update();
}

int lost_sticks(const std::vector<hw::PolarFrame>& frames) {
  std::ptrdiff_t lost = 0;
  for (const hw::PolarFrame& frame : frames) lost += std::ranges::count(frame.arrived, 0);
  return static_cast<int>(lost);
}

}  // namespace

LiveRenderer::LiveRenderer(
    render::GlContext& context,
    LivePanel& panel,
    std::function<void(SharedPicture)> show,
    std::function<void(const LivePicture&, const render::Picture&)> show_compared,
    double patience_ms)
    : context_(context),
      panel_(panel),
      show_(std::move(show)),
      show_compared_(std::move(show_compared)),
      patience_ms_(patience_ms),
      state_(panel.state()) {
  renderer_ =
      std::make_unique<render::Renderer>(context_, state_->scene.plan(), state_->scene.render());
  renderer_->compile();
  const auto frames = state_->scene.plan().acquisition().frames_per_volume;
  current_.resize(static_cast<std::size_t>(frames));
}

void LiveRenderer::begin_volume(std::uint32_t volume) {
  volume_ = volume;
}

double LiveRenderer::add_frame(int frame, const hw::PolarFrame& samples) {
  follow();
  current_.at(static_cast<std::size_t>(frame)) = samples;
  renderer_->add_frame(frame, samples);
  const double ms = renderer_->update().ms;
  if (!std::ranges::all_of(current_, is_here)) return ms;
  whole_ = std::make_shared<const std::vector<hw::PolarFrame>>(
      std::exchange(current_, std::vector<hw::PolarFrame>(current_.size())));
  last_volume_ = volume_;
  return ms;
}

render::Picture LiveRenderer::render() {
  const auto state = panel_.state();
  if (state != state_) take(state);
  return make_picture();
}

/// Whether there is a new picture.
bool LiveRenderer::follow() {
  const auto state = panel_.state();
  const bool has_changed = state != state_;
  if (has_changed) take(state);
  if (!whole_) return false;
  if (has_changed && show_coarse()) panel_.wait(panel_.orders(), state_->serial, kUntilDrawn);
  if (panel_.state() != state_) return true;  // the picture of all pixels would be late
  if (has_changed) make_picture();
  compare();
  return has_changed;
}

void LiveRenderer::compare() {
  const std::uint64_t asked = panel_.comparisons();
  const auto options = panel_.start_options();
  if (asked == compared_ || !options) return;
  compared_ = asked;
  if (!shown_ || shown_->frames != whole_) make_picture();
  render::Renderer other(context_, state_->scene.plan(), *options);
  add_all(*whole_, other);
  show_compared_(*shown_, other.render());
}

/// A state that this machine cannot render is refused, and the last one stays.
void LiveRenderer::take(const std::shared_ptr<const LiveState>& state) {
  const auto& options = state->scene.render();
  try {
    if (renderer_->keeps_slices(options)) {
      renderer_->set_options(options);
    } else {
      rebuild(state);
    }
    state_ = state;
  } catch (const render::ContextLost&) {
    throw;
  } catch (const std::exception&) {
    panel_.revert(state_, state->settings, refusal_of(std::current_exception()).line);
    state_ = panel_.state();
  }
}

/// A renderer of other slices, with the volumes that are here.
void LiveRenderer::rebuild(const std::shared_ptr<const LiveState>& state) {
  auto renderer =
      std::make_unique<render::Renderer>(context_, state->scene.plan(), state->scene.render());
  renderer_ = std::move(renderer);
  if (whole_) add_all(*whole_, *renderer_);
  add_all(current_, *renderer_);
}

void LiveRenderer::begin_stream() {
  const bool has_part = std::ranges::any_of(current_, is_here);
  current_.assign(current_.size(), {});
  if (!has_part) return;
  // The last whole volume takes the place of the part.
  whole_ ? add_all(*whole_, *renderer_) : rebuild(state_);
}

LivePicture LiveRenderer::rendered() {
  const auto begin = hw::HostClock::now();
  render::Picture picture = renderer_->render(render::Rays::keep);
  return {.picture = std::move(picture),
          .state = state_,
          .volume = last_volume_.value_or(volume_),
          .frames = whole_,
          .lost_sticks = whole_ ? lost_sticks(*whole_) : 0,
          .render_ms = to_milliseconds(hw::HostClock::now() - begin)};
}

render::Picture LiveRenderer::make_picture() {
  const bool casts = !renderer_->has_rays();
  shown_ = std::make_shared<const LivePicture>(rendered());
  if (casts) cast_ms_ = shown_->render_ms;
  show_(shown_);
  return shown_->picture;
}

bool LiveRenderer::show_coarse() {
  render::RenderOptions coarse = state_->scene.render();
  int& side = coarse.ray_casting.image_size;
  if (renderer_->has_rays() || cast_ms_ <= patience_ms_ || side < 2) return false;
  side /= 2;
  renderer_->set_options(coarse);
  LivePicture picture = rendered();
  picture.is_coarse = true;
  show_(std::make_shared<const LivePicture>(std::move(picture)));
  renderer_->set_options(state_->scene.render());
  return true;
}

}  // namespace wobblebench::bench
