#include "bench/studies/evaluator/evaluator.h"

#include <chrono>
#include <utility>

#include "base/duration.h"
#include "bench/cache/phantom_cache.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

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
      maps_(kept_maps(cache.tissue_maps())),
      renderers_(scene_, context),
      truths_(maps_) {}

RenderSetting Evaluator::render_setting(const Scene& setting) const {
  return {resolve_scene(setting, subject().phantom).render(), program_setting(setting.picture)};
}

void Evaluator::scan(sim::Rung rung, std::uint64_t seed) {
  Scene options = scene_.options();
  options.simulation.fidelity = rung;
  options.simulation.seed = seed;
  scene_ = ResolvedScene(std::move(options), scene_.subject());
  const sim::ProbeSimulator simulator(subject(), scene_.plan(), scene_.simulation(), maps_);
  renderers_.scan(volume_of(simulator));
  rung_ = simulator.fidelity().rung;
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
    return renderers_.of(setting.options, as_new);
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
  const auto* shaded =
      choice.measures.shaded
          ? timed(times.truth_ms, [&] { return truths_.shaded(scene_, rung_, options); })
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
