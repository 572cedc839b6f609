// z between passes 2 and 3: its correction for the beam's width, and pass 3's filter.
#pragma once

#include "hw/probe/beam_width.h"
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

/// Length of the correction on a surface that is tilted from stick to stick or from frame to frame,
/// and between them the root of the mean of both squares, weighted by the squares of the normal's
/// components. `beam` is read for automatic lengths alone.
hw::BeamWidth correction_length(const RayCastingOptions& options, const hw::BeamWidth& beam);

/// Moves the surface along each ray by correction_length() times the tangent of the angle between
/// its normal and the stick through it, at most kMaxTangent. The normal is that of z averaged over
/// kNormalWindow_m, so that a surface's roughness stays as it is. Does nothing where
/// RayCastingOptions::incidence_correction_m is 0.
class IncidenceCorrection {
 public:
  IncidenceCorrection() = default;
  IncidenceCorrection(const SliceGeometry& geometry,
                      const hw::BeamWidths& beam,
                      const RenderOptions& options);

  /// Whether these options ask for it.
  static bool acts(const RenderOptions& options);

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

/// Automatic length: this share of the beam's two-way -6 dB width, chosen for the default level
/// (docs/decisions/0054-correction-by-the-beam.md).
inline constexpr double kShareOfWidth = 0.5;
/// Largest tangent of incidence: 60 degrees. Beyond it the beam is wider than the part of a curved
/// surface that has one tangent, and the normal of the rim is not known well.
inline constexpr double kMaxTangent = 1.73;
/// Side of the window in which z is averaged for its normal.
inline constexpr double kNormalWindow_m = 2.5e-3;
/// The same in pixels of the picture: odd, 3 to 31.
int normal_window(const RenderOptions& options);

}  // namespace wobblebench::render
