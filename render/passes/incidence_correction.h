// Between passes 2 and 3: corrects z for the beam's width.
#pragma once

#include "render/geometry/slice_geometry.h"
#include "render/gl/program.h"
#include "render/options.h"
#include "render/passes/surface_depth.h"

namespace wobblebench::render {

/// Moves the surface along each ray by RayCastingOptions::incidence_correction_m times the tangent
/// of the angle between its normal and the stick through it, at most kMaxTangent. The normal is
/// that of z averaged over kNormalWindow_m, so that a surface's roughness stays as it is. Does
/// nothing where the correction is 0.
class IncidenceCorrection {
 public:
  IncidenceCorrection() = default;
  IncidenceCorrection(const SliceGeometry& geometry, const RenderOptions& options);

  /// Another view with the same projection.
  void set_view(const RenderOptions& options);
  /// Corrects RayCaster::depth(). Returns the corrected z, or `depth` itself.
  const Texture& correct(const Texture& depth);

 private:
  bool active_ = false;
  DepthFilter filter_;
  Texture corrected_;
  Framebuffer target_;
  FragmentProgram program_;
};

/// Largest tangent of incidence: 68 degrees; beyond it the normal of the rim is not known well.
inline constexpr double kMaxTangent = 2.5;
/// Side of the window in which z is averaged for its normal.
inline constexpr double kNormalWindow_m = 2.5e-3;
/// The same in pixels of the picture: odd, 3 to 31.
int normal_window(const RenderOptions& options);

}  // namespace wobblebench::render
