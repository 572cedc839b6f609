// Pass 3: the z-buffer filtered, lit and shadowed.
#pragma once

#include "render/gl_program.h"
#include "render/options.h"

namespace wobblebench::render {

/// Paper section 3.3, Eq. (2).
class SurfaceShader {
 public:
  explicit SurfaceShader(const RenderOptions& options);

  /// Shades z as RayCaster::depth() gives it.
  void shade(const Texture& depth);

  const Texture& filtered_depth() const { return filtered_; }
  /// RGB in [0, 1]; black where there is no surface.
  const Texture& surface() const { return surface_; }

 private:
  Texture filtered_, surface_;
  Framebuffer filtered_target_, surface_target_;
  FragmentProgram filter_, shade_;
};

}  // namespace wobblebench::render
