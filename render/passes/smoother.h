// Pass 4: the final picture smoothed.
#pragma once

#include <vector>

#include "render/gl/program.h"
#include "render/options.h"

namespace wobblebench::render {

/// Paper section 3.4; the guided filter is that of docs/references.md [19].
class Smoother {
 public:
  /// Both modes give the same picture; `fast` takes the windows of box and guided line by line.
  Smoother(const SmoothingOptions& options, int image_size, PipelineMode mode);

  /// Takes and gives RGB in [0, 1].
  void smooth(const Texture& picture);
  const Texture& smoothed() const { return smoothed_; }

 private:
  Texture between_, smoothed_;
  Framebuffer between_target_, smoothed_target_;
  /// Drawn one after the other, each from the picture and the step before.
  std::vector<FragmentProgram> steps_;
};

/// Bilateral filter: standard deviation over the picture, in pixels, for a filter of this size.
constexpr double bilateral_spatial_sigma(int filter_size) {
  return filter_size / 4.0;
}

}  // namespace wobblebench::render
