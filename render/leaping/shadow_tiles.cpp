#include "render/leaping/shadow_tiles.h"

#include "render/camera.h"
#include "render/passes/lighting.h"

namespace wobblebench::render {
namespace {

enum Bindings { kDepth, kTiles, kQuadrants, kWideQuadrants, kNearest };

FragmentProgram nearest_program(int block) {
  return {
      {"nearest.frag.glsl"},
      Defines().add("BIND_DEPTH", kDepth).add("BLOCK", block).add("NOTHING_NEAR", kNothingNear)};
}

FragmentProgram clear_program(const RenderOptions& options) {
  FragmentProgram program({"view.glsl", "quadrant.glsl", "shadow_clear.frag.glsl"},
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
  const int across = (image_size + kShadowTile - 1) / kShadowTile;
  const std::string what = "shadow tiles of an image_size of " + std::to_string(image_size);
  const auto map = [&](TexelFormat format, int side) {
    return Texture(what, format, {side, side}, TextureFilter::nearest);
  };
  tiles_ = map(TexelFormat::r32f, across);
  quadrants_ = map(TexelFormat::rgba32f, across);
  wide_quadrants_ = map(TexelFormat::rgba32f, across);
  nearest_ = map(TexelFormat::r32f, 1);
  tiles_target_ = Framebuffer({&tiles_});
  quadrants_target_ = Framebuffer({&quadrants_, &wide_quadrants_});
  nearest_target_ = Framebuffer({&nearest_});
  reduce_ = nearest_program(kShadowTile);
  spread_ =
      FragmentProgram({"shadow_tiles.frag.glsl"},
                      Defines().add("BIND_NEAREST", kTiles).add("NOTHING_NEAR", kNothingNear));
  reduce_all_ = nearest_program(across);
  if (options.view.projection == Projection::perspective) return;
  clear_ = map(TexelFormat::rg32f, across);
  clear_target_ = Framebuffer({&clear_});
  follow_ = clear_program(options);
}

void ShadowTiles::update(const Texture& depth) {
  reduce_.draw(tiles_target_, {{kDepth, &depth}});
  spread_.draw(quadrants_target_, {{kTiles, &tiles_}});
  reduce_all_.draw(nearest_target_, {{kDepth, &tiles_}});
  if (!clear_) return;
  follow_.draw(
      clear_target_,
      {{kQuadrants, &quadrants_}, {kWideQuadrants, &wide_quadrants_}, {kNearest, &nearest_}});
}

}  // namespace wobblebench::render
