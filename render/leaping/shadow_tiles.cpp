#include "render/leaping/shadow_tiles.h"

#include "render/camera.h"
#include "render/geometry/lighting.h"

namespace wobblebench::render {
namespace {

enum Bindings { kDepth, kTiles, kQuadrants, kWideQuadrants, kNearest };

FragmentProgram nearest_program(int block) {
  return {
      {"nearest.frag.glsl"},
      Defines().add("BIND_DEPTH", kDepth).add("BLOCK", block).add("NOTHING_NEAR", kNothingNear)};
}

FragmentProgram lit_depth_program(const RenderOptions& options) {
  FragmentProgram program({"view.glsl", "quadrant.glsl", "shadow_lit_depth.frag.glsl"},
                          Defines()
                              .add("BIND_QUADRANTS", kQuadrants)
                              .add("BIND_WIDE_QUADRANTS", kWideQuadrants)
                              .add("BIND_NEAREST", kNearest)
                              .add("TILE", kShadowTile)
                              .add("PERSPECTIVE", 0)
                              .add("POINT_LIGHT", options.shading.light == Light::point));
  const Camera camera = make_camera(options);
  program.set("pixel_m", camera.pixel_m())
      .set("image_size", static_cast<double>(camera.image_size))
      .set("light_position_m", light_position_m(options.shading, camera))
      .set("light_direction", light_direction(options.shading))
      .set("shadow_bias_m", options.shading.shadow_bias_m);
  return program;
}

}  // namespace

ShadowTiles::ShadowTiles(const RenderOptions& options) {
  const int image_size = options.ray_casting.image_size;
  const int tiles = (image_size + kShadowTile - 1) / kShadowTile;
  const std::string what = "shadow tiles of an image_size of " + std::to_string(image_size);
  const auto map = [&](TexelFormat format, int side) {
    return Texture(what, format, {side, side}, TextureFilter::nearest);
  };
  tiles_ = map(TexelFormat::r32f, tiles);
  quadrants_ = map(TexelFormat::rgba32f, tiles);
  wide_quadrants_ = map(TexelFormat::rgba32f, tiles);
  nearest_ = map(TexelFormat::r32f, 1);
  tiles_target_ = Framebuffer({&tiles_});
  quadrants_target_ = Framebuffer({&quadrants_, &wide_quadrants_});
  nearest_target_ = Framebuffer({&nearest_});
  reduce_ = nearest_program(kShadowTile);
  gather_ =
      FragmentProgram({"shadow_tiles.frag.glsl"},
                      Defines().add("BIND_NEAREST", kTiles).add("NOTHING_NEAR", kNothingNear));
  reduce_all_ = nearest_program(tiles);
  if (options.view.projection == Projection::perspective) return;
  lit_depth_ = map(TexelFormat::rg32f, tiles);
  lit_depth_target_ = Framebuffer({&lit_depth_});
  trace_ = lit_depth_program(options);
}

void ShadowTiles::update(const Texture& depth) {
  reduce_.draw(tiles_target_, {{kDepth, &depth}});
  gather_.draw(quadrants_target_, {{kTiles, &tiles_}});
  reduce_all_.draw(nearest_target_, {{kDepth, &tiles_}});
  if (!lit_depth_) return;
  trace_.draw(
      lit_depth_target_,
      {{kQuadrants, &quadrants_}, {kWideQuadrants, &wide_quadrants_}, {kNearest, &nearest_}});
}

}  // namespace wobblebench::render
