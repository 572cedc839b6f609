#include "bench/studies/evaluator/kept_renderers.h"

#include <algorithm>
#include <utility>

#include "bench/scene/scene_cost.h"

namespace wobblebench::bench {

namespace {

constexpr double kMostRenderers = 4;

std::size_t renderers_in_memory(const Scene& scene) {
  const MemoryNeed need = memory_need(scene);
  const double fitting = available_memory_bytes() / 4 / (need.slices + need.pictures);
  return static_cast<std::size_t>(std::clamp(fitting, 1.0, kMostRenderers));
}

}  // namespace

KeptRenderers::KeptRenderers(const ResolvedScene& scene, render::GlContext& context)
    : plan_(scene.plan()), context_(context), most_(renderers_in_memory(scene.options())) {}

void KeptRenderers::scan(hw::PolarVolume sticks) {
  sticks_ = std::move(sticks);
  ++scans_;
}

/// One with these settings; else, of two with the same slices, the one whose last use is longer ago
/// (the other may be what settings are compared with); else a new one.
KeptRenderers::Kept& KeptRenderers::with(const render::RenderOptions& options) {
  const auto last = [&](auto found) -> Kept& {
    renderers_.splice(renderers_.end(), renderers_, found);
    return renderers_.back();
  };
  const auto keeps = [&](const Kept& kept) { return kept.renderer->keeps_slices(options); };
  const auto same = std::ranges::find(renderers_, options, &Kept::options);
  if (same != renderers_.end()) return last(same);
  const auto kept = std::ranges::find_if(renderers_, keeps);
  const bool is_spare = std::ranges::count_if(renderers_, keeps) > 1;
  if (kept != renderers_.end() && (is_spare || most_ == 1)) {
    kept->renderer->set_options(options);
    kept->options = options;
    kept->is_compiled = false;
    return last(kept);
  }
  if (renderers_.size() >= most_) renderers_.pop_front();
  auto renderer = std::make_unique<render::Renderer>(context_, plan_, options);
  return renderers_.emplace_back(Kept{std::move(renderer), options});
}

render::Renderer& KeptRenderers::of(const render::RenderOptions& options, bool as_new) {
  Kept& kept = with(options);
  if (as_new && !std::exchange(kept.is_compiled, true)) kept.renderer->compile();
  const bool has_sticks = std::exchange(kept.scan, scans_) == scans_;
  if (as_new || !has_sticks) kept.renderer->add_volume(sticks());
  return *kept.renderer;
}

}  // namespace wobblebench::bench
