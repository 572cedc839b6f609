// The four passes of the paper (docs/references.md [1]) on OpenGL.
#pragma once

#include <memory>

#include "hw/polar_volume.h"
#include "render/gl_context.h"
#include "render/image.h"
#include "render/options.h"

namespace wobblebench::render {

/// One renderer for one acquisition plan. The context must outlive it. All calls from the thread
/// that owns the context.
class Renderer {
 public:
  /// Throws hw::InvalidOption; std::runtime_error when the driver cannot (names limit and need).
  Renderer(GlContext& context, const hw::AcquisitionPlan& plan, const RenderOptions& options);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Pass 1 for one frame: scan-converts, filters and stores it as its slice.
  void add_frame(int frame_index, const hw::PolarFrame& frame);

  /// Passes 2 to 4 over the slices as they are. Pass times of all frames added since the last
  /// picture are summed as `scan_conversion`.
  Picture render();

 private:
  struct Passes;
  std::unique_ptr<Passes> passes_;
};

/// All frames of a volume, then the picture.
Picture render_volume(GlContext& context,
                      const hw::PolarVolume& volume,
                      const RenderOptions& options);

}  // namespace wobblebench::render
