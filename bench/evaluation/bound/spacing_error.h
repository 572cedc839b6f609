// What the spacing of sticks and frames costs: the error of a surface that is known exactly on each
// stick and linear between them. Neither beam nor speckle has a part in it.
#pragma once

#include <cstdint>

#include "base/image.h"
#include "bench/evaluation/bound/picture_bound.h"
#include "bench/evaluation/truth/scanned_surfaces.h"
#include "bench/evaluation/truth/truth.h"
#include "phantoms/placed_phantom.h"
#include "render/view.h"

namespace wobblebench::bench {

/// Where the sticks meet the true surface, and where any other stick would.
struct StickRanges {
  Image<float> ranges_m;  ///< column = line, row = frame; kNoSurface: none in the view's box
  ScannedSurfaces surfaces;
};

StickRanges stick_ranges_m(const phantoms::PlacedPhantom& subject,
                           const hw::AcquisitionPlan& plan,
                           const render::View& view,
                           std::uint32_t volume = 0);

struct SpacingError {
  double rms_m = 0;  ///< along the picture's rays; NaN where n is 0
  double p95_m = 0;  ///< of the magnitude
  int n = 0;
  int unsupported = 0;  ///< counted pixels left out: the sum of the three below
  int hidden = 0;       ///< the stick through the pixel's point meets a surface before it
  int outside = 0;      ///< not between four sticks that meet a surface each
  /// Between the pixel's stick and one of the four the range jumps: seen from the probe, a
  /// silhouette passes between them, and no reconstruction joins both sides.
  int parted = 0;
  double with_parted_rms_m = 0;  ///< those counted, too
  Image<float> map_m;            ///< signed, positive too deep; kNoSurface where there is none
};

/// A stick's point is a pixel's if it lies this near; the truth's depths are exact to 0.02 mm.
inline constexpr double kSamePoint_m = 0.3e-3;
/// Sticks that are traced between a pixel and each of its four. The range jumps where it
/// changes by more from one to the next than along a surface at kGrazing_rad: by more than some 3
/// mm where sticks are 2 mm apart. A smaller step counts as a slope.
inline constexpr int kTracedSticks = 8;

/// The error of ranges interpolated in angle between the four sticks about each pixel's true point,
/// to first order in it. The yardstick of a picture is sqrt(between_sticks_m^2 + rms_m^2), of
/// picture_bound() and this.
///
/// @code
/// const auto sticks = bench::stick_ranges_m(subject, plan, view);
/// const auto spacing = bench::spacing_error(
///     truth, view.camera, plan, sticks, [](int, int) { return true; });
/// const double yardstick_m = std::hypot(bound.between_sticks_m, spacing.rms_m);
/// @endcode
SpacingError spacing_error(const Truth& truth,
                           const render::Camera& camera,
                           const hw::AcquisitionPlan& plan,
                           const StickRanges& sticks,
                           const CountedPixel& counted);

}  // namespace wobblebench::bench
