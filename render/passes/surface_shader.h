// Pass 3: filter, Blinn-Phong shading and cast shadows of the z-buffer.
#pragma once

#include "render/gl/program.h"
#include "render/leaping/shadow_tiles.h"
#include "render/options.h"
#include "render/passes/surface_depth.h"

namespace wobblebench::render {

/// Paper section 3.3, Eq. (2).
class SurfaceShader {
 public:
  explicit SurfaceShader(const RenderOptions& options);

  /// Shades RayCaster::depth(); with ShadingBase::rendered, RayCaster::color() on it.
  void shade(const Texture& depth, const Texture& color);

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
