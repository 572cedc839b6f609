// The four-pass renderer of the paper (docs/references.md [1]) on OpenGL.
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "render/gl/context.h"
#include "render/gl/texels.h"
#include "render/options.h"
#include "render/picture.h"

namespace wobblebench::hw {
class AcquisitionPlan;
class PolarVolume;
struct PolarFrame;
}  // namespace wobblebench::hw

namespace wobblebench::render {

/// What pass 1 made of a volume, as pass 2 reads it.
struct VolumeSlices {
  Region pixels;                     ///< of a slice, those that are stored
  int sweep = 1;                     ///< of the motor, as hw::AcquisitionPlan::sweep_direction
  std::vector<Image<float>> slices;  ///< one for each frame, of `pixels`; samples in [0, 1]
};

/// z between passes 2 and 3: ray lengths in metres, kNoSurface without a surface.
struct CastDepth {
  Image<float> cast_m;  ///< of pass 2
  Image<float>
      depth_m;  ///< corrected by RayCastingOptions::incidence_correction_m: Picture::depth_m
  Image<float> filtered_m;  ///< `depth_m` after pass 3's homogeneous filter
};

/// Functions that Renderer::render() calls between the passes with what the last one made. They
/// must not use the context or the renderer; what they throw leaves render(). One that is not set
/// costs nothing; reading for one that is set counts in no pass.
///
/// @code
/// #include "hw/probe/polar_volume.h"
/// const hw::PolarVolume volume(hw::AcquisitionPlan({}, {}));
/// const auto context = render::make_context();
/// render::Renderer renderer(*context, volume.plan(), render::RenderOptions{});
/// render::RenderTaps taps;
/// taps.depth = [](const render::CastDepth& depth) {
///   Image<float> nearer_m = depth.depth_m;
///   for (float& z : nearer_m.pixels) z -= 1e-3F;
///   return nearer_m;
/// };
/// renderer.set_taps(taps);
/// renderer.add_volume(volume);
/// const render::Picture picture = renderer.render();  // a millimetre nearer
/// @endcode
struct RenderTaps {
  /// After pass 1.
  std::function<void(const VolumeSlices&)> slices;
  /// After pass 2. Passes 3 and 4 go on with the z that it returns, an image of the same size,
  /// kNoSurface where there is none; without one with their own. A replacement is a pass of its own
  /// in Picture::passes, `correction`, from reading z to having the new one on the GPU. render()
  /// throws std::invalid_argument for an image of another size.
  std::function<std::optional<Image<float>>(const CastDepth&)> depth;
  /// After pass 3, linear RGB in [0, 1].
  std::function<void(const Image<glm::vec3>&)> shaded;
  /// After pass 4: Picture::surface.
  std::function<void(const Image<glm::vec3>&)> smoothed;
};

/// What Renderer::render() does about pass 2. `keep`: leaves it out where its last z and volume
/// picture are those of this picture, too, because nothing but shading and smoothing has changed
/// since. Pictures are the same by either.
enum class Rays { cast, keep };

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
  /// called before the frames of a whole volume; changes no picture of that.
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

  /// Passes 2 to 4. `scan_conversion` is the cost of all updates since the last picture. With
  /// Rays::keep, Picture::passes has no `ray_casting` where that was left out; with a tap of depth
  /// it never is.
  Picture render(Rays rays = Rays::cast);

  /// For the pictures that follow; replaces those set before.
  void set_taps(RenderTaps taps);

  /// Whether set_options() takes these: pass 1, with the reconstruction before it, makes the same
  /// by them. True of whatever concerns passes 2 to 4 only, but for a detector that needs the
  /// levels of echoes where the one before did not, or a kernel that reads beyond the slices.
  bool keeps_slices(const RenderOptions& options) const;
  /// Whether render(Rays::keep) has rays to keep: nothing that they depend on has changed.
  bool has_rays() const;
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
