// The four passes of the paper (docs/references.md [1]) on OpenGL.
#pragma once

#include <memory>

#include "hw/probe/polar_volume.h"
#include "render/gl/context.h"
#include "render/options.h"
#include "render/picture.h"

namespace wobblebench::render {

/// One renderer for one acquisition plan. The context must outlive it. All calls from the thread
/// that owns the context.
///
/// A volume is complete when each of its frames has been added since the last that was. Pictures
/// show the last complete volume (black before the first), or, with `pipeline.mid_volume`, each
/// frame as soon as update() has seen it, beside those of the volume before.
class Renderer {
 public:
  /// Throws InvalidOption; std::runtime_error when the driver cannot (names limit and need).
  Renderer(GlContext& context, const hw::AcquisitionPlan& plan, const RenderOptions& options);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Takes a frame; no GL yet. Throws std::out_of_range for an index outside the plan,
  /// std::invalid_argument for a frame of another size.
  void add_frame(int frame_index, const hw::PolarFrame& frame);

  /// All frames of a volume, in their order.
  void add_volume(const hw::PolarVolume& volume);

  /// Pass 1 for the frames added since the last call: makes the slices that they settle, with
  /// mid_volume all that they change. To be called as frames arrive, so that it overlaps with their
  /// acquisition; render() calls it too. Returns its cost.
  PassTime update();

  /// Passes 2 to 4. `scan_conversion` is the cost of all updates since the last picture.
  Picture render();

  /// The volume, seen from elsewhere. Throws InvalidOption.
  void look(const ViewOptions& view);

 private:
  struct Passes;
  std::unique_ptr<Passes> passes_;
};

/// All frames of a volume, then the picture.
Picture render_volume(GlContext& context,
                      const hw::PolarVolume& volume,
                      const RenderOptions& options);

}  // namespace wobblebench::render
