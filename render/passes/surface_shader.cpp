#include "render/passes/surface_shader.h"

#include "render/camera.h"
#include "render/geometry/lighting.h"
#include "render/passes/ray_caster.h"

namespace wobblebench::render {
namespace {

enum ShadeBinding { kShadeDepth, kShadeQuadrants, kShadeNearest, kShadeLitDepth, kShadeColor };

Defines shade_defines(const RenderOptions& options) {
  return Defines()
      .add("BIND_DEPTH", kShadeDepth)
      .add("BIND_QUADRANTS", kShadeQuadrants)
      .add("BIND_NEAREST", kShadeNearest)
      .add("BIND_LIT_DEPTH", kShadeLitDepth)
      .add("BIND_COLOR", kShadeColor)
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
  return {{"view.glsl", "shadows.glsl", "surface_shade.frag.glsl"}, shade_defines(options)};
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

namespace tiles {
enum ShadeBinding { kShadeDepth, kTiles, kShadeQuadrants, kWideQuadrants, kShadeNearest };
}

FragmentProgram nearest_program(int block) {
  return {{"nearest.frag.glsl"},
          Defines()
              .add("BIND_DEPTH", tiles::kShadeDepth)
              .add("BLOCK", block)
              .add("NOTHING_NEAR", kNothingNear)};
}

FragmentProgram lit_depth_program(const RenderOptions& options) {
  return {{"view.glsl", "shadow_lit_depth.frag.glsl"},
          Defines()
              .add("BIND_QUADRANTS", tiles::kShadeQuadrants)
              .add("BIND_WIDE_QUADRANTS", tiles::kWideQuadrants)
              .add("BIND_NEAREST", tiles::kShadeNearest)
              .add("TILE", kShadowTile)
              .add("PERSPECTIVE", 0)
              .add("POINT_LIGHT", options.shading.light == Light::point)};
}

}  // namespace

SurfaceShader::SurfaceShader(const RenderOptions& options)
    : depth_filter_size_(options.shading.depth_filter_size),
      defines_(shade_defines(options).text()),
      leaps_(options.shading.shadows && options.pipeline.mode == PipelineMode::fast),
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

void SurfaceShader::set_shading(const RenderOptions& options) {
  if (options.shading.depth_filter_size != depth_filter_size_ ||
      shade_defines(options).text() != defines_) {
    *this = SurfaceShader(options);
    return;
  }
  set_uniforms(shade_, options);
  if (leaps_) tiles_.set_light(options);
  check_gl("surface shading: setting up");
}

void SurfaceShader::shade(const Texture& depth, const Texture& color) {
  filter_.filter(depth);
  if (leaps_) {
    tiles_.update(filtered_depth());
    shade_.draw(target_,
                {{kShadeDepth, &filtered_depth()},
                 {kShadeQuadrants, &tiles_.quadrants()},
                 {kShadeNearest, &tiles_.nearest()},
                 {kShadeLitDepth, &tiles_.lit_depth()},
                 {kShadeColor, &color}});
  } else {
    shade_.draw(target_, {{kShadeDepth, &filtered_depth()}, {kShadeColor, &color}});
  }
  check_gl("surface shading");
}

ShadowTiles::ShadowTiles(const RenderOptions& options) {
  const int image_size = options.ray_casting.image_size;
  const int side = (image_size + kShadowTile - 1) / kShadowTile;
  const std::string what = "shadow tiles of an image_size of " + std::to_string(image_size);
  const auto map = [&](TexelFormat format, int texels) {
    return Texture(what, format, {texels, texels}, TextureFilter::nearest);
  };
  tiles_ = map(TexelFormat::r32f, side);
  quadrants_ = map(TexelFormat::rgba32f, side);
  wide_quadrants_ = map(TexelFormat::rgba32f, side);
  nearest_ = map(TexelFormat::r32f, 1);
  tiles_target_ = Framebuffer({&tiles_});
  quadrants_target_ = Framebuffer({&quadrants_, &wide_quadrants_});
  nearest_target_ = Framebuffer({&nearest_});
  reduce_ = nearest_program(kShadowTile);
  gather_ = FragmentProgram(
      {"shadow_tiles.frag.glsl"},
      Defines().add("BIND_NEAREST", tiles::kTiles).add("NOTHING_NEAR", kNothingNear));
  reduce_all_ = nearest_program(side);
  if (options.view.projection == Projection::perspective) return;
  lit_depth_ = map(TexelFormat::rg32f, side);
  lit_depth_target_ = Framebuffer({&lit_depth_});
  trace_ = lit_depth_program(options);
  set_light(options);
}

void ShadowTiles::set_light(const RenderOptions& options) {
  if (!trace_) return;
  const Camera camera = make_camera(options);
  trace_.set("pixel_m", camera.pixel_m())
      .set("image_size", static_cast<double>(camera.image_size))
      .set("light_position_m", light_position_m(options.shading, camera))
      .set("light_direction", light_direction(options.shading))
      .set("shadow_bias_m", options.shading.shadow_bias_m);
}

void ShadowTiles::update(const Texture& depth) {
  reduce_.draw(tiles_target_, {{tiles::kShadeDepth, &depth}});
  gather_.draw(quadrants_target_, {{tiles::kTiles, &tiles_}});
  reduce_all_.draw(nearest_target_, {{tiles::kShadeDepth, &tiles_}});
  if (!lit_depth_) return;
  trace_.draw(lit_depth_target_,
              {{tiles::kShadeQuadrants, &quadrants_},
               {tiles::kWideQuadrants, &wide_quadrants_},
               {tiles::kShadeNearest, &nearest_}});
}

}  // namespace wobblebench::render
