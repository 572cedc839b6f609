// Pass 2: rays through the slices; alpha blending and surface detection.
#pragma once

#include "render/camera.h"
#include "render/gl/program.h"
#include "render/options.h"
#include "render/passes/slice_geometry.h"
#include "render/passes/slice_volume.h"

namespace wobblebench::render {

/// Paper section 3.2. Mode `plain` takes every step of every ray. Mode `fast` leaps over what holds
/// neither surface nor opacity (render/leaping/skippable_cells.h), and is the same otherwise.
///
/// Taps outside the cone of valid data carry no weight.
///
/// Where z is: the ray length of the newest sample in the buffer when Difference reaches the
/// threshold (the paper's definition), a smoothed sample belonging to its kernel's middle. For a
/// step of contrast C across the surface and 0 < threshold < (buffer_length / 2) C, this lies past
/// the edge by (threshold / C - 1/2) steps on average with refine_crossing, and by half a step more
/// without. The buffer counts once it is full of samples in a row inside the cone.
class RayCaster {
 public:
  /// For `volume`, and all others of its maker.
  RayCaster(const SliceGeometry& geometry, const RenderOptions& options, const SliceVolume& volume);

  /// From elsewhere, in the same projection.
  void look(const RenderOptions& options);
  void cast(SliceVolume& volume);

  /// Volume picture: RGB, opacity.
  const Texture& color() const { return color_; }
  /// Ray length at the surface, kNoDepth where there is none.
  const Texture& depth() const { return depth_; }

 private:
  void set_box(const RenderOptions& options);
  void set_cone(const Region& pixels);
  void set_motion_table();
  void set_fan();
  void set_leaps(const SkippableCells& cells);
  void set_sampling(const RenderOptions& options);

  SliceGeometry geometry_;
  Texture motion_table_, transfer_, color_, depth_;
  Framebuffer target_;
  FragmentProgram ray_cast_;
};

/// z of a pixel without a surface in depth textures.
inline constexpr int kNoDepth = -1;

}  // namespace wobblebench::render
