#include "render/passes/incidence_correction.h"

#include <algorithm>
#include <cmath>

#include "render/camera.h"
#include "render/passes/ray_caster.h"

namespace wobblebench::render {
namespace {

enum Bindings { kDepth, kFiltered };

}  // namespace

int normal_window(const RenderOptions& options) {
  const double pixels = kNormalWindow_m / make_camera(options).pixel_m();
  return 2 * static_cast<int>(std::clamp(std::floor(0.5 * pixels), 1.0, 15.0)) + 1;
}

IncidenceCorrection::IncidenceCorrection(const SliceGeometry& geometry,
                                         const RenderOptions& options)
    : active_(options.ray_casting.incidence_correction_m > 0 &&
              options.ray_casting.mode != RenderMode::volume) {
  if (!active_) return;
  const int size = options.ray_casting.image_size;
  filter_ = DepthFilter(options, normal_window(options));
  corrected_ = Texture("ray_casting.image_size = " + std::to_string(size),
                       TexelFormat::r32f,
                       {size, size},
                       TextureFilter::nearest);
  target_ = Framebuffer({&corrected_});
  program_ =
      FragmentProgram({"ray.glsl", "incidence.frag.glsl"},
                      Defines()
                          .add("BIND_DEPTH", kDepth)
                          .add("BIND_FILTERED", kFiltered)
                          .add("PERSPECTIVE", options.view.projection == Projection::perspective));
  program_.set("axis_z_m", geometry.axis_z_m())
      .set("correction_m", options.ray_casting.incidence_correction_m)
      .set("max_tangent", kMaxTangent);
  set_view(options);
  check_gl("incidence correction: setting up");
}

void IncidenceCorrection::set_view(const RenderOptions& options) {
  if (active_) set_camera(program_, options);
}

const Texture& IncidenceCorrection::correct(const Texture& depth) {
  if (!active_) return depth;
  filter_.filter(depth);
  program_.draw(target_, {{kDepth, &depth}, {kFiltered, &filter_.filtered()}});
  check_gl("incidence correction");
  return corrected_;
}

}  // namespace wobblebench::render
