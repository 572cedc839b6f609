// Pass 3: the z-buffer filtered, lit and shadowed.
#pragma once

#include "render/depth_filter.h"
#include "render/gl_program.h"
#include "render/options.h"
#include "render/shadow_tiles.h"

namespace wobblebench::render {

/// Paper section 3.3, Eq. (2).
class SurfaceShader {
 public:
  explicit SurfaceShader(const RenderOptions& options);

  /// Shades z as RayCaster::depth() gives it.
  void shade(const Texture& depth);

  const Texture& filtered_depth() const { return filter_.filtered(); }
  /// RGB in [0, 1]; black where there is no surface.
  const Texture& surface() const { return surface_; }

 private:
  bool leaps_;
  DepthFilter filter_;
  ShadowTiles tiles_;
  Texture surface_;
  Framebuffer target_;
  FragmentProgram shade_;
};

}  // namespace wobblebench::render
