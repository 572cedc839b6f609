// Pass 4: the final picture smoothed.
#pragma once

#include "render/gl_program.h"
#include "render/options.h"

namespace wobblebench::render {

/// Paper section 3.4.
class Smoother {
 public:
  Smoother(const SmoothingOptions& options, int image_size);

  void smooth(const Texture& picture);
  const Texture& smoothed() const { return smoothed_; }

 private:
  Texture smoothed_;
  Framebuffer target_;
  FragmentProgram filter_;
};

/// Bilateral filter: standard deviation over the picture, in pixels, for a filter of this size.
constexpr double bilateral_spatial_sigma(int filter_size) {
  return filter_size / 4.0;
}

}  // namespace wobblebench::render
