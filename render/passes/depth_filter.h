// Pass 3, first half: z filtered.
#pragma once

#include "render/gl/program.h"
#include "render/options.h"

namespace wobblebench::render {

/// The homogeneous filter of z over neighbours that have a surface, paper section 3.3. The fast
/// form takes rows and then columns, and sums z relative to the distance of the picture's middle:
/// what is left is the rounding of z itself, 2e-8 m at 0.4 m and 5e-7 m at 10 m.
class DepthFilter {
 public:
  DepthFilter() = default;
  explicit DepthFilter(const RenderOptions& options);

  /// Filters z as RayCaster::depth() gives it.
  void filter(const Texture& depth);

  /// z in metres; kNoDepth where the pixel itself has no surface.
  const Texture& filtered() const { return filtered_; }

 private:
  bool fast_ = false;
  Texture sums_, filtered_;
  Framebuffer sums_target_, filtered_target_;
  FragmentProgram rows_, filter_;  ///< plain has no rows_
};

}  // namespace wobblebench::render
