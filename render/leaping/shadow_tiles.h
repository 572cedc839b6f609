// Pass 3, fast: what the trace of shadows leaps over.
#pragma once

#include "render/gl/program.h"
#include "render/options.h"

namespace wobblebench::render {

/// Pixels a side of the tiles.
inline constexpr int kShadowTile = 8;
/// Nearest z of a tile without a surface, in metres: beyond whatever a picture shows. A whole
/// number, as shaders' constants are.
inline constexpr int kNothingNear = 1'000'000;

/// The nearest z of each tile of a height map, and of the whole map.
class ShadowTiles {
 public:
  ShadowTiles() = default;
  explicit ShadowTiles(const RenderOptions& options);

  /// Takes z as DepthFilter::filtered() gives it.
  void update(const Texture& depth);

  /// Nearest z in metres of a tile and its neighbours, one channel for each quadrant
  /// (shaders/shadow_tiles.frag.glsl).
  const Texture& quadrants() const { return quadrants_; }
  /// Nearest z in metres of the whole map; one texel.
  const Texture& nearest() const { return nearest_; }
  /// How deep in metres rays in a tile may be and be lit, in their next kShadowTile samples and in
  /// all after those. Only in parallel projection, and otherwise empty
  /// (shaders/shadow_clear.frag.glsl).
  const Texture& clear() const { return clear_; }

 private:
  Texture tiles_, quadrants_, wide_quadrants_, nearest_, clear_;
  Framebuffer tiles_target_, quadrants_target_, nearest_target_, clear_target_;
  FragmentProgram reduce_, spread_, reduce_all_, follow_;
};

}  // namespace wobblebench::render
