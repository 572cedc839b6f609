// Pass 3: Blinn-Phong shading and cast shadows of the filtered z-buffer; in mode fast, the tiles
// that the trace of shadows leaps over.
#pragma once

#include <string>

#include "render/gl/program.h"
#include "render/options.h"
#include "render/passes/surface_depth.h"

namespace wobblebench::render {

/// Pixels per side of a tile.
inline constexpr int kShadowTile = 8;
/// Minimum z of a tile without a surface, in metres: beyond any picture. An integer, as the
/// shaders' constants are.
inline constexpr int kNothingNear = 1'000'000;

/// Mode fast: minimum z of each tile of a height map and of the whole map.
class ShadowTiles {
 public:
  ShadowTiles() = default;
  explicit ShadowTiles(const RenderOptions& options);

  /// `depth`: DepthFilter::filtered().
  void update(const Texture& depth);

  /// Minimum z in metres of a tile and its neighbours, one channel for each quadrant of directions
  /// (shaders/shading/shadow_tiles.frag.glsl).
  const Texture& quadrants() const { return quadrants_; }
  /// Minimum z in metres of the whole map; one texel.
  const Texture& nearest() const { return nearest_; }
  /// Largest depth in metres at which rays over a tile are lit in their next kShadowTile samples,
  /// and in all samples after those (shaders/shading/shadow_lit_depth.frag.glsl). Empty in
  /// perspective projection.
  const Texture& lit_depth() const { return lit_depth_; }

  /// Another direction, place or bias of the same kind of light.
  void set_light(const RenderOptions& options);

 private:
  Texture tiles_, quadrants_, wide_quadrants_, nearest_, lit_depth_;
  Framebuffer tiles_target_, quadrants_target_, nearest_target_, lit_depth_target_;
  FragmentProgram reduce_, gather_, reduce_all_, trace_;
};

/// Paper section 3.3, Eq. (2).
class SurfaceShader {
 public:
  explicit SurfaceShader(const RenderOptions& options);

  /// Options that differ from those before in shading alone. What the shaders hold as a number
  /// costs next to nothing.
  void set_shading(const RenderOptions& options);

  /// The filter of z alone, as shade() does it first.
  void filter(const Texture& depth) { filter_.filter(depth); }
  /// Shades RayCaster::depth(); with ShadingBase::rendered, RayCaster::color() on it.
  void shade(const Texture& depth, const Texture& color);

  const Texture& filtered_depth() const { return filter_.filtered(); }
  /// RGB in [0, 1]; black where there is no surface.
  const Texture& surface() const { return surface_; }

 private:
  int depth_filter_size_;
  std::string defines_;  ///< of shade_
  bool leaps_;
  DepthFilter filter_;
  ShadowTiles tiles_;
  Texture surface_;
  Framebuffer target_;
  FragmentProgram shade_;
};

}  // namespace wobblebench::render
