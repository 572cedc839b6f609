// z between passes 2 and 3: its correction for the beam's width, and pass 3's filter.
#pragma once

#include "render/geometry/slice_geometry.h"
#include "render/gl/program.h"
#include "render/options.h"

namespace wobblebench::render {

/// Homogeneous filter of z over neighbours that have a surface, paper section 3.3. Mode fast
/// filters rows and then columns and sums z relative to the distance of the picture's centre, so
/// that only the rounding of z itself remains: 2e-8 m at 0.4 m, 5e-7 m at 10 m.
class DepthFilter {
 public:
  DepthFilter() = default;
  /// `size`: side of the window, pixels, odd.
  DepthFilter(const RenderOptions& options, int size);

  /// Filters RayCaster::depth().
  void filter(const Texture& depth);

  /// z in metres; kNoDepth where the pixel itself has no surface.
  const Texture& filtered() const { return filtered_; }

 private:
  bool fast_ = false;
  Texture sums_, filtered_;
  Framebuffer sums_target_, filtered_target_;
  FragmentProgram rows_, filter_;  ///< rows_: mode fast only
};

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
