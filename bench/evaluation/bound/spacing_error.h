// What the spacing of sticks and frames costs: the error of a surface that is known exactly on each
// stick and linear between them. Neither beam nor speckle has a part in it.
#pragma once

#include <cstdint>

#include "base/image.h"
#include "bench/evaluation/bound/picture_bound.h"
#include "bench/evaluation/truth/truth.h"
#include "phantoms/placed_phantom.h"
#include "render/view.h"

namespace wobblebench::bench {

/// Range of the true surface on each stick: column = line, row = frame. kNoSurface where the stick
/// meets none in the view's box.
Image<float> stick_ranges_m(const phantoms::PlacedPhantom& subject,
                            const hw::AcquisitionPlan& plan,
                            const render::View& view,
                            std::uint32_t volume = 0);

struct SpacingError {
  double rms_m = 0;  ///< along the picture's rays; NaN where n is 0
  double p95_m = 0;  ///< of the magnitude
  int n = 0;
  /// Counted pixels left out: not between four sticks that meet their surface. The sticks' ranges
  /// must differ by kOneSurface_m at most, the pixel's lie between them or kBulge_m beyond.
  int unsupported = 0;
  Image<float> map_m;  ///< signed, positive too deep; kNoSurface where there is none
};

inline constexpr double kOneSurface_m = 10e-3;  ///< neighbours on a slope of 70 degrees
inline constexpr double kBulge_m = 3e-3;

/// The error of ranges interpolated in angle between the four sticks about each pixel's true point,
/// to first order in it. The yardstick of a picture is sqrt(between_sticks_m^2 + rms_m^2), of
/// picture_bound() and this.
///
/// @code
/// const auto ranges_m = bench::stick_ranges_m(subject, plan, view);
/// const auto spacing = bench::spacing_error(
///     truth, view.camera, plan, ranges_m, [](int, int) { return true; });
/// const double yardstick_m = std::hypot(bound.between_sticks_m, spacing.rms_m);
/// @endcode
SpacingError spacing_error(const Truth& truth,
                           const render::Camera& camera,
                           const hw::AcquisitionPlan& plan,
                           const Image<float>& ranges_m,
                           const CountedPixel& counted);

}  // namespace wobblebench::bench
