// One way to score a render setting: phantom, tissue maps, sticks and truth are made once, settings
// change on living renderers.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "bench/cache/phantom_cache.h"
#include "bench/evaluation/measures/picture_measures.h"
#include "bench/evaluation/registration/registration.h"
#include "bench/exchange/program/program_renderer.h"
#include "bench/scene/resolved_scene.h"
#include "bench/studies/evaluator/kept_renderers.h"
#include "bench/studies/evaluator/kept_truths.h"

namespace wobblebench::bench {

/// Wall times of the parts of one evaluation; 0: the part was there already, or not asked for.
struct EvaluationTimes {
  double renderer_ms = 0;  ///< making the renderer and giving it the sticks, or other settings
  double render_ms = 0;    ///< the picture, with pass 1 where the sticks are new
  double truth_ms = 0;     ///< with its shading
  double measure_ms = 0;
  double registration_ms = 0;
};

/// Time of one picture, in ms: the sum over the passes.
struct PictureTime {
  double volume_ms = 0;  ///< of a new volume: all passes
  double view_ms = 0;    ///< of a volume that is there: passes 2 to 4
};

struct Evaluation {
  PictureMeasures measures;
  std::optional<Registration> registration;  ///< none: not asked for
  render::Picture picture;
  EvaluationTimes times;
  PictureTime picture_time;  ///< 0: not asked for
};

/// How a picture is rendered: by our renderer, or by a program of others.
struct RenderSetting {
  // NOLINTNEXTLINE(google-explicit-constructor): options alone are our renderer's.
  RenderSetting(render::RenderOptions of = {}, ProgramSetting by = {})
      : options(std::move(of)), program(std::move(by)) {}

  render::RenderOptions options;
  ProgramSetting program;
};

struct EvaluationChoice {
  MeasureChoice measures;
  bool registration = false;
  bool picture_time = false;
};

/// All calls come from the thread that owns the context. Only volume 0 is looked at.
///
/// @code
/// #include <cstdio>
/// const auto context = render::make_context();
/// bench::PhantomCache cache;
/// bench::Evaluator evaluator(bench::load_scene({}, {"phantom.name=sphere"}), *context, cache);
/// evaluator.scan(sim::Rung::field, 7);
/// render::RenderOptions options = evaluator.scene().render();
/// options.ray_casting.threshold = 0.2;
/// const bench::Evaluation scored = evaluator.evaluate(options);
/// std::printf("P95 %g m\n", scored.measures.raw.depth.p95_m);
/// @endcode
class Evaluator {
 public:
  /// Makes the phantom, by `cache`, which must outlive this, as must the context. Throws UserError.
  Evaluator(const Scene& scene, render::GlContext& context, PhantomCache& cache);

  /// The scene, with the rung and the seed of the last scan().
  const ResolvedScene& scene() const { return scene_; }
  const phantoms::PlacedPhantom& subject() const { return *scene_.subject(); }
  /// Render settings of another scene, whose phantom and scan are this one's.
  RenderSetting render_setting(const Scene& setting) const;

  /// The sticks that following evaluations render. Throws InvalidOption.
  void scan(sim::Rung rung, std::uint64_t seed);
  const hw::PolarVolume& sticks() const { return renderers_.sticks(); }
  /// The rung that was chosen; only with sticks.
  sim::Rung rung() const { return rung_; }

  /// Needs sticks. Throws InvalidOption, and as render::Renderer does.
  Evaluation evaluate(const RenderSetting& setting, const EvaluationChoice& choice = {});
  /// Times the picture of a new volume, which the sticks are given as, by programs that are
  /// compiled. Throws as evaluate().
  PictureTime time_picture(const RenderSetting& setting);
  /// The truth of a view, with what the sticks' rung cannot hear.
  const TrueView& truth(const render::RenderOptions& options) {
    return truths_.of(scene_, rung_, options);
  }

 private:
  render::Picture picture_of(const RenderSetting& setting, bool as_new, EvaluationTimes& times);
  ProgramRenderer& program_of(const ProgramSetting& setting);

  ResolvedScene scene_;
  sim::TissueMapSource maps_;
  sim::Rung rung_ = sim::Rung::automatic;
  KeptRenderers renderers_;
  KeptTruths truths_;
  std::unique_ptr<ProgramRenderer> program_;  ///< the last one that was used
};

}  // namespace wobblebench::bench
