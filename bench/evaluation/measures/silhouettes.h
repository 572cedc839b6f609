// The band about silhouettes, where one pixel's ray and the next one's meet different surfaces.
#pragma once

#include <cstdint>

#include "bench/evaluation/truth/truth.h"
#include "render/camera.h"

namespace wobblebench::bench {

/// Half width of the band, across the ray: the spacing of frames, and about the width of the beam,
/// at the depth of the default face (docs/decisions/0028-measures.md).
inline constexpr double kBandWidth_m = 3e-3;

/// 1 in the pixels within `width_m` of one where the true surface ends, where its depth jumps by
/// more than kSurfaceJump_m to the next pixel, or which is grazing. The picture's border and pixels
/// that the probe's field does not reach end no surface.
Image<std::uint8_t> silhouette_band(const Truth& truth,
                                    const render::Camera& camera,
                                    double width_m = kBandWidth_m);

}  // namespace wobblebench::bench
