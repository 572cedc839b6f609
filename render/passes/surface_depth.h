// Pass 3, first half: filter of the z-buffer.
#pragma once

#include "render/gl/program.h"
#include "render/options.h"

namespace wobblebench::render {

/// Homogeneous filter of z over neighbours that have a surface, paper section 3.3. Mode fast
/// filters rows and then columns and sums z relative to the distance of the picture's centre, so
/// that only the rounding of z itself remains: 2e-8 m at 0.4 m, 5e-7 m at 10 m.
class DepthFilter {
 public:
  DepthFilter() = default;
  /// `size`: side of the window, pixels, odd.
  DepthFilter(const RenderOptions& options, int size);

  /// Filters RayCaster::depth().
  void filter(const Texture& depth);

  /// z in metres; kNoDepth where the pixel itself has no surface.
  const Texture& filtered() const { return filtered_; }

 private:
  bool fast_ = false;
  Texture sums_, filtered_;
  Framebuffer sums_target_, filtered_target_;
  FragmentProgram rows_, filter_;  ///< rows_: mode fast only
};

}  // namespace wobblebench::render
