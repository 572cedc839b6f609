// The border of the surface in a picture, where the probe loses it.
#pragma once

#include <cstdint>

#include "base/image.h"
#include "hw/probe/probe.h"
#include "render/options.h"

namespace wobblebench::render {

/// Beyond this angle between its normal and the stick a surface is lost, sooner or later, to noise
/// and total reflection; its border there is smoothed.
inline constexpr double kSteepBorder_rad = 65 * kDegree;
/// Largest distance from the border of what is drawn or left out.
inline constexpr double kOutlineBand_m = 6e-3;

/// Smooths the border of z, metres, to pixels without a surface, where the surface beside it is
/// steep: the surface ends where a Gaussian mean of its pixels, with the standard deviation
/// RayCastingOptions::outline_m, is one half, once the mean's own rounding of curves is made up
/// for. Pixels beyond are left out (kNoSurface); those within that have no z continue a quadratic
/// surface through their neighbours.
void smooth_outline(Image<double>& depth_m,
                    const hw::ProbeGeometry& geometry,
                    const RenderOptions& options);

/// What pass 2 found, with its outline smoothed and its small pieces left out.
Image<double> finished_surface(const Image<double>& found_m,
                               const hw::ProbeGeometry& geometry,
                               const RenderOptions& options);

/// 1: has a z that was not found.
Image<std::uint8_t> drawn_beyond(const Image<double>& found_m, const Image<double>& depth_m);

}  // namespace wobblebench::render
