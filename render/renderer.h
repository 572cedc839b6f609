// The four-pass renderer of the paper (docs/references.md [1]) on OpenGL.
#pragma once

#include <future>
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
/// Its host may use the context, too, between the calls: each sets the state of OpenGL 4.5 core
/// that its work depends on, and gives back what it found (render/gl/host_state.h):
///   bindings       draw and read framebuffer, program, vertex array, pixel pack and unpack buffer,
///                  active texture; textures (2D, 3D, 2D array) and samplers of units 0 to 4
///   rasterizing    viewport 0; polygon mode, smoothing and offset; culling, rasterizer discard,
///                  depth clamp, clip control, clip distances, primitive restart
///   per fragment   scissor 0; blending and colour masks of draw buffers 0 to 7; logic op, dither;
///                  depth and stencil test, multisampling, sample masks, coverage and shading, sRGB
///                  conversion
///   transfers      all of glPixelStore
///   running        transform feedback is paused; while a timer query of the host runs, `gpu_ms` is
///                  not measured; other queries count the renderer's draws
/// The context stays current. GL errors that the host left are dropped, and a program that it
/// deleted while current ends. No call may stand within glBeginConditionalRender, which OpenGL does
/// not tell.
///
/// @code
/// #include "hw/probe/polar_volume.h"
/// const hw::PolarVolume volume(hw::AcquisitionPlan({}, {}));
/// const auto context = render::make_context();
/// render::Renderer renderer(*context, volume.plan(), render::RenderOptions{});
/// renderer.add_volume(volume);
/// render::Picture picture = renderer.render();
/// renderer.set_view({.yaw_rad = 30 * kDegree});
/// picture = renderer.render();
/// @endcode
class Renderer {
 public:
  /// Throws InvalidOption; std::runtime_error, with limit and need, beyond the driver's limits.
  /// Every call throws ContextLost (render/gl/context.h) once the driver says so.
  Renderer(GlContext& context, const hw::AcquisitionPlan& plan, const RenderOptions& options);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Draws a pixel of each pass, for drivers that compile a program at its first draw: llvmpipe
  /// does, which takes most of the first picture's time unless Mesa's disk cache has it. To be
  /// called before the first frame; changes no picture.
  void compile();
  /// The same on a thread of its own, to which the context and the renderer belong until get(),
  /// which throws what compile() throws.
  [[nodiscard]] std::future<void> compile_in_background();

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

  /// Whether set_options() takes these: pass 1, with the reconstruction before it, makes the same
  /// by them. True of whatever concerns passes 2 to 4 only, but for a detector that needs the
  /// levels of echoes where the one before did not, or a kernel that reads beyond the slices.
  bool keeps_slices(const RenderOptions& options) const;
  /// Settings of the following pictures; the volumes that are there stay. Throws InvalidOption,
  /// std::invalid_argument without keeps_slices(), std::runtime_error beyond the driver's limits;
  /// then all is as it was.
  void set_options(const RenderOptions& options);
  /// The same for the view alone, which takes next to no time.
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
