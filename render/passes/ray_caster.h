// Pass 2: ray casting through the slices. Edge detection (Eq. (1)) gives z, alpha blending the
// volume picture.
#pragma once

#include "render/camera.h"
#include "render/geometry/slice_geometry.h"
#include "render/gl/program.h"
#include "render/options.h"
#include "render/passes/slice_volume.h"

namespace wobblebench::render {

/// Paper section 3.2. Mode `plain` takes every step of every ray. Mode `fast` leaps over cells
/// without surface and opacity (render/leaping/skippable_cells.h); otherwise it is the same.
///
/// Taps of the kernel outside the cone of valid data carry no weight.
///
/// z is the ray length of the newest sample in the buffer when Difference of Eq. (1) reaches the
/// threshold (the paper's definition); a smoothed sample lies at its kernel's middle. For a step of
/// contrast C across the surface and 0 < threshold < (buffer_length / 2) C, z lies behind the edge
/// by (threshold / C - 1/2) steps on average with refine_crossing, and by half a step more without.
/// Difference is valid once the buffer holds buffer_length consecutive samples inside the cone.
class RayCaster {
 public:
  /// For `volume` and all others of its factory.
  RayCaster(const SliceGeometry& geometry, const RenderOptions& options, SliceVolume& volume);

  /// Another view with the same projection.
  void set_view(const RenderOptions& options);
  void cast(SliceVolume& volume);

  /// Volume picture: RGB and opacity.
  const Texture& color() const { return color_; }
  /// z: ray length at the surface in metres; kNoDepth if there is none.
  const Texture& depth() const { return depth_; }

 private:
  void set_box(const RenderOptions& options);
  void set_cone(const Region& pixels);
  void set_motion_table();
  void set_fan();
  void set_macrocells(const SkippableCells& cells);
  void set_sampling(const RenderOptions& options);

  SliceGeometry geometry_;
  bool measures_level_;  ///< the threshold is that of the volume
  bool leaps_ = false;   ///< over cells of the volume's empty space
  Texture motion_table_, transfer_, color_, depth_;
  Framebuffer target_;
  FragmentProgram ray_cast_;
};

/// The uniforms of shaders/ray_casting/ray.glsl that place a picture's rays.
void set_camera(FragmentProgram& program, const RenderOptions& options);

/// z of a pixel without a surface, in depth textures.
inline constexpr int kNoDepth = -1;

}  // namespace wobblebench::render
