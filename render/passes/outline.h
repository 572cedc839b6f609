// The border of the surface in a picture, where the probe loses it.
#pragma once

#include <cstdint>

#include "base/image.h"
#include "hw/probe/probe.h"
#include "render/options.h"

namespace wobblebench::render {

/// What pass 2 found, z in metres, with its border smoothed and its small pieces left out.
///
/// Where the surface beside its border to pixels without one is steep, it ends where a Gaussian
/// mean of its pixels, with the standard deviation RayCastingOptions::outline_m, is one half, once
/// the mean's own rounding of curves is made up for. Pixels beyond are left out (kNoSurface); those
/// within that have no z continue a quadratic surface through their neighbours.
Image<double> finished_surface(const Image<double>& found_m,
                               const hw::ProbeGeometry& geometry,
                               const RenderOptions& options);

/// 1: has a z that was not found.
Image<std::uint8_t> drawn_beyond(const Image<double>& found_m, const Image<double>& depth_m);

}  // namespace wobblebench::render
