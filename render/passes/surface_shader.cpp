#include "render/passes/surface_shader.h"

#include "render/camera.h"
#include "render/geometry/lighting.h"
#include "render/passes/ray_caster.h"

namespace wobblebench::render {
namespace {

enum Bindings { kDepth, kQuadrants, kNearest, kLitDepth, kColor };

Defines shade_defines(const RenderOptions& options) {
  return Defines()
      .add("BIND_DEPTH", kDepth)
      .add("BIND_QUADRANTS", kQuadrants)
      .add("BIND_NEAREST", kNearest)
      .add("BIND_LIT_DEPTH", kLitDepth)
      .add("BIND_COLOR", kColor)
      .add("RENDERED_BASE", options.shading.base == ShadingBase::rendered)
      .add("FAST", options.pipeline.mode == PipelineMode::fast)
      .add("TILE", kShadowTile)
      .add("NO_SURFACE", kNoDepth)
      .add("PERSPECTIVE", options.view.projection == Projection::perspective)
      .add("POINT_LIGHT", options.shading.light == Light::point)
      .add("SHADOWS", options.shading.shadows)
      .add("MAX_SHADOW_STEPS", max_shadow_steps(options.ray_casting.image_size));
}

FragmentProgram shade_program(const RenderOptions& options) {
  const bool fast = options.pipeline.mode == PipelineMode::fast;
  const std::string_view shadow = fast ? "shadow_leaps.glsl" : "shadow_trace.glsl";
  return {{"view.glsl", "height_map.glsl", "quadrant.glsl", shadow, "surface_shade.frag.glsl"},
          shade_defines(options)};
}

void set_uniforms(FragmentProgram& program, const RenderOptions& options) {
  const Camera camera = make_camera(options);
  const ShadingOptions& o = options.shading;
  program.set("pixel_m", camera.pixel_m())
      .set("image_size", static_cast<double>(camera.image_size))
      .set("eye_distance_m", camera.eye_distance_m)
      .set("light_position_m", light_position_m(o, camera))
      .set("light_direction", light_direction(o))
      .set("base_rgb", o.base_rgb)
      .set("ambient", o.ambient)
      .set("diffuse", o.diffuse)
      .set("specular", o.specular)
      .set("shininess", o.shininess)
      .set("shadow_coefficient", o.shadow_coefficient)
      .set("shadow_bias_m", o.shadow_bias_m);
}

}  // namespace

SurfaceShader::SurfaceShader(const RenderOptions& options)
    : leaps_(options.shading.shadows && options.pipeline.mode == PipelineMode::fast),
      filter_(options, options.shading.depth_filter_size),
      shade_(shade_program(options)) {
  const int size = options.ray_casting.image_size;
  surface_ = Texture("ray_casting.image_size = " + std::to_string(size),
                     TexelFormat::rgba32f,
                     {size, size},
                     TextureFilter::nearest);
  target_ = Framebuffer({&surface_});
  if (leaps_) tiles_ = ShadowTiles(options);
  set_uniforms(shade_, options);
  check_gl("surface shading: setting up");
}

void SurfaceShader::shade(const Texture& depth, const Texture& color) {
  filter_.filter(depth);
  if (leaps_) {
    tiles_.update(filtered_depth());
    shade_.draw(target_,
                {{kDepth, &filtered_depth()},
                 {kQuadrants, &tiles_.quadrants()},
                 {kNearest, &tiles_.nearest()},
                 {kLitDepth, &tiles_.lit_depth()},
                 {kColor, &color}});
  } else {
    shade_.draw(target_, {{kDepth, &filtered_depth()}, {kColor, &color}});
  }
  check_gl("surface shading");
}

}  // namespace wobblebench::render
