// The yardstick: the same four passes on the CPU in double precision, written for clarity.
#pragma once

#include "hw/probe/polar_volume.h"
#include "render/options.h"
#include "render/picture.h"

namespace wobblebench::render {

/// Same inputs, same settings, same outputs as render_volume(); no pass times.
Picture render_reference(const hw::PolarVolume& volume, const RenderOptions& options);

/// Passes 3 and 4 alone, on any depth image: how the truth is shaded the same way.
/// The depth image has image_size pixels a side; `volume` is black.
Picture shade_depth(const Image<float>& depth_m, const RenderOptions& options);

}  // namespace wobblebench::render
