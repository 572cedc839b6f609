// Pass 4: smoothing of the shaded picture.
#pragma once

#include <vector>

#include "render/gl/program.h"
#include "render/options.h"

namespace wobblebench::render {

/// Paper section 3.4; the guided filter is that of docs/references.md [19].
class Smoother {
 public:
  /// Both modes give the same picture; `fast` filters rows and columns in turn for box and guided.
  Smoother(const SmoothingOptions& options, int image_size, PipelineMode mode);

  /// `picture`: RGB in [0, 1].
  void smooth(const Texture& picture);
  const Texture& smoothed() const { return smoothed_; }

 private:
  Texture between_, smoothed_;
  Framebuffer between_target_, smoothed_target_;
  /// Drawn in order, each from the picture and the result of the previous one.
  std::vector<FragmentProgram> steps_;
};

}  // namespace wobblebench::render
