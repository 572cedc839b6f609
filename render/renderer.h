// The four-pass renderer of the paper (docs/references.md [1]) on OpenGL.
#pragma once

#include <memory>

#include "render/gl/context.h"
#include "render/options.h"
#include "render/picture.h"

namespace wobblebench::hw {
class AcquisitionPlan;
class PolarVolume;
struct PolarFrame;
}  // namespace wobblebench::hw

namespace wobblebench::render {

/// Renders the volumes of one acquisition plan. The context must outlive the renderer; all calls
/// come from the thread that owns the context.
///
/// A volume is complete when each of its frames has been added since the last complete one.
/// Pictures show the last complete volume (black before the first), or, with
/// `pipeline.mid_volume`, each frame as soon as update() has processed it, beside those of the
/// previous volume.
///
/// @code
/// #include "hw/probe/polar_volume.h"
/// const hw::PolarVolume volume(hw::AcquisitionPlan({}, {}));
/// const auto context = render::make_context("osmesa");
/// render::Renderer renderer(*context, volume.plan(), render::RenderOptions{});
/// renderer.add_volume(volume);
/// render::Picture picture = renderer.render();
/// renderer.set_view({.yaw_rad = 30 * kDegree});
/// picture = renderer.render();
/// @endcode
class Renderer {
 public:
  /// Throws InvalidOption; std::runtime_error, with limit and need, beyond the driver's limits.
  Renderer(GlContext& context, const hw::AcquisitionPlan& plan, const RenderOptions& options);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Stores a frame of log-compressed samples on the CPU. Throws std::out_of_range for an index
  /// outside the plan, std::invalid_argument for a frame of another size.
  void add_frame(int frame_index, const hw::PolarFrame& frame);

  /// Adds all frames of a volume, in their order. Throws std::invalid_argument for a volume of
  /// linear envelopes (hw::PolarVolume::log_compress()).
  void add_volume(const hw::PolarVolume& volume);

  /// Pass 1 for the frames added since the last call: makes the slices whose frames have all
  /// arrived; with mid_volume all that changed. Call it as frames arrive to overlap pass 1 with
  /// their acquisition; render() calls it too. Returns its cost.
  PassTime update();

  /// Passes 2 to 4. `scan_conversion` is the cost of all updates since the last picture.
  Picture render();

  /// Sets the view of the following pictures. Throws InvalidOption.
  void set_view(const ViewOptions& view);

 private:
  struct Pipeline;
  std::unique_ptr<Pipeline> pipeline_;
};

/// Renders one volume.
Picture render_volume(GlContext& context,
                      const hw::PolarVolume& volume,
                      const RenderOptions& options);

}  // namespace wobblebench::render
