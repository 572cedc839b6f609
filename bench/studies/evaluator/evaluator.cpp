#include "bench/studies/evaluator/evaluator.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/duration.h"
#include "bench/cache/phantom_cache.h"
#include "bench/scene/scene_cost.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

constexpr int kMostRenderers = 4;
constexpr std::size_t kMostTruths = 8;

/// Number of living renderers that fit into a quarter of the memory, at least one.
std::size_t renderers_in_memory(const Scene& scene) {
  const MemoryNeed need = memory_need(scene);
  const double each = need.slices + need.pictures;
  const double fitting = available_memory_bytes() / 4 / each;
  return static_cast<std::size_t>(std::clamp(fitting, 1.0, 1.0 * kMostRenderers));
}

/// Runs `body` and adds its wall time.
template <class Body>
decltype(auto) timed(double& ms, const Body& body) {
  struct Watch {
    double& ms;
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
    ~Watch() { ms += to_milliseconds(std::chrono::steady_clock::now() - start); }
  };
  const Watch watch{ms};
  return body();
}

/// Every render option, as a text that two settings share only if they are equal.
std::string key_of(const render::RenderOptions& options) {
  Scene scene;
  scene.render = options;
  return resolved(scene).dump();
}

/// What the true surface of a pixel depends on.
render::RenderOptions view_of(const render::RenderOptions& options) {
  render::RenderOptions view;
  view.view = options.view;
  view.volume_of_interest = options.volume_of_interest;
  view.ray_casting.image_size = options.ray_casting.image_size;
  view.ray_casting.edge = options.ray_casting.edge;
  return view;
}

hw::PolarVolume volume_of(const sim::ProbeSimulator& simulator) {
  const sim::SimulationOptions& options = simulator.options();
  auto volume =
      hw::PolarVolume::of_samples(simulator.plan(), 0, options.output, simulator.volume(0));
  volume.log_compress(options.dynamic_range_db);
  return volume;
}

PictureTime time_of(const render::Picture& picture) {
  PictureTime time;
  for (const render::PassTime& pass : picture.passes) time.volume_ms += pass.ms;
  time.view_ms = time.volume_ms - picture.passes.front().ms;
  return time;
}

}  // namespace

Evaluator::Evaluator(const Scene& scene, render::GlContext& context, PhantomCache& cache)
    : scene_(resolve_scene(scene, cache.phantom(scene.phantom))),
      context_(context),
      maps_(kept_maps(cache.tissue_maps())),
      most_renderers_(renderers_in_memory(scene_.options())) {}

RenderSetting Evaluator::render_setting(const Scene& setting) const {
  return {resolve_scene(setting, subject().phantom).render(), program_setting(setting.picture)};
}

void Evaluator::scan(sim::Rung rung, std::uint64_t seed) {
  Scene options = scene_.options();
  options.simulation.fidelity = rung;
  options.simulation.seed = seed;
  scene_ = ResolvedScene(std::move(options), scene_.subject());
  const sim::ProbeSimulator simulator(subject(), scene_.plan(), scene_.simulation(), maps_);
  sticks_ = volume_of(simulator);
  rung_ = simulator.fidelity().rung;
  ++scans_;
}

const StickReach& Evaluator::reach() {
  const auto found = reach_.find(rung_);
  if (found != reach_.end()) return found->second;
  return reach_.emplace(rung_, StickReach(scene_, maps_)).first->second;
}

const TrueView& Evaluator::truth(const render::RenderOptions& options) {
  const std::string key = sim::to_string(rung_) + key_of(view_of(options));
  const auto found = truths_.find(key);
  if (found != truths_.end()) return found->second;
  if (truths_.size() >= kMostTruths) truths_.clear();
  const render::View view = render::make_view(options);
  Truth truth = true_surface(scene_, view, reach());
  return truths_.emplace(key, TrueView(std::move(truth), view.camera)).first->second;
}

/// nullptr where it depends on the picture, too.
const Image<glm::vec3>* Evaluator::shaded_truth(const render::RenderOptions& options) {
  if (options.shading.base == render::ShadingBase::rendered) return nullptr;
  render::RenderOptions shown = view_of(options);
  shown.shading = options.shading;
  shown.smoothing = options.smoothing;
  const std::string key = sim::to_string(rung_) + key_of(shown);
  const auto found = shaded_.find(key);
  if (found != shaded_.end()) return &found->second;
  if (shaded_.size() >= kMostTruths) shaded_.clear();
  return &shaded_.emplace(key, shade_truth(truth(options).truth, options, {})).first->second;
}

/// One with these settings; else, of two with the same slices, the one whose last use is longer ago
/// (the other may be what settings are compared with); else a new one.
Evaluator::LivingRenderer& Evaluator::living_renderer(const render::RenderOptions& options) {
  const auto last = [&](auto found) -> LivingRenderer& {
    renderers_.splice(renderers_.end(), renderers_, found);
    return renderers_.back();
  };
  const auto same = [&](const LivingRenderer& living) { return living.options == options; };
  const auto keeps = [&](const LivingRenderer& living) {
    return living.renderer->keeps_slices(options);
  };
  const auto found = std::find_if(renderers_.begin(), renderers_.end(), same);
  if (found != renderers_.end()) return last(found);
  const auto kept = std::find_if(renderers_.begin(), renderers_.end(), keeps);
  const bool is_spare = std::count_if(renderers_.begin(), renderers_.end(), keeps) > 1;
  if (kept != renderers_.end() && (is_spare || most_renderers_ == 1)) {
    kept->renderer->set_options(options);
    kept->options = options;
    kept->is_compiled = false;
    return last(kept);
  }
  if (renderers_.size() >= most_renderers_) renderers_.pop_front();
  auto renderer = std::make_unique<render::Renderer>(context_, scene_.plan(), options);
  LivingRenderer& living = renderers_.emplace_back();
  living.renderer = std::move(renderer);
  living.options = options;
  return living;
}

/// `as_new`: with the sticks as a new volume, and compiled, so that the next picture takes no
/// longer than others.
render::Renderer& Evaluator::renderer_of(const render::RenderOptions& options, bool as_new) {
  LivingRenderer& living = living_renderer(options);
  render::Renderer& renderer = *living.renderer;
  if (as_new && !std::exchange(living.is_compiled, true)) renderer.compile();
  const bool has_sticks = std::exchange(living.scan, scans_) == scans_;
  if (as_new || !has_sticks) renderer.add_volume(sticks());
  return renderer;
}

ProgramRenderer& Evaluator::program_of(const ProgramSetting& setting) {
  if (!program_ || program_->setting() != setting) {
    program_.reset();
    program_ = std::make_unique<ProgramRenderer>(setting);
  }
  return *program_;
}

render::Picture Evaluator::picture_of(const RenderSetting& setting,
                                      bool as_new,
                                      EvaluationTimes& times) {
  if (setting.program.any()) {
    ProgramRenderer& program =
        timed(times.renderer_ms, [&]() -> ProgramRenderer& { return program_of(setting.program); });
    return timed(times.render_ms, [&] { return program.render(sticks(), setting.options); });
  }
  render::Renderer& renderer = timed(times.renderer_ms, [&]() -> render::Renderer& {
    return renderer_of(setting.options, as_new);
  });
  return timed(times.render_ms, [&] { return renderer.render(); });
}

Evaluation Evaluator::evaluate(const RenderSetting& setting, const EvaluationChoice& choice) {
  Evaluation result;
  EvaluationTimes& times = result.times;
  const render::RenderOptions& options = setting.options;
  result.picture = picture_of(setting, choice.picture_time, times);
  if (choice.picture_time) result.picture_time = time_of(result.picture);
  const TrueView& view = timed(times.truth_ms, [&]() -> const TrueView& { return truth(options); });
  const auto* shaded = choice.measures.shaded
                           ? timed(times.truth_ms, [&] { return shaded_truth(options); })
                           : nullptr;
  result.measures = timed(times.measure_ms, [&] {
    return measure_picture(result.picture, view, options, choice.measures, shaded);
  });
  if (choice.registration) {
    result.registration = timed(times.registration_ms, [&] {
      return register_surface(
          result.picture.depth_m, subject(), scene_.plan(), render::make_view(options));
    });
  }
  return result;
}

PictureTime Evaluator::time_picture(const RenderSetting& setting) {
  EvaluationTimes ignored;
  return time_of(picture_of(setting, true, ignored));
}

}  // namespace wobblebench::bench
