// Pass 3, mode fast: tiles of the height map that the trace of shadows leaps over.
#pragma once

#include "render/gl/program.h"
#include "render/options.h"

namespace wobblebench::render {

/// Pixels per side of a tile.
inline constexpr int kShadowTile = 8;
/// Minimum z of a tile without a surface, in metres: beyond any picture. An integer, as the
/// shaders' constants are.
inline constexpr int kNothingNear = 1'000'000;

/// Minimum z of each tile of a height map and of the whole map.
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

 private:
  Texture tiles_, quadrants_, wide_quadrants_, nearest_, lit_depth_;
  Framebuffer tiles_target_, quadrants_target_, nearest_target_, lit_depth_target_;
  FragmentProgram reduce_, gather_, reduce_all_, trace_;
};

}  // namespace wobblebench::render
