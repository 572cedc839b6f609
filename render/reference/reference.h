// Reference renderer: the same four passes on the CPU in double precision, written for clarity.
#pragma once

#include "render/options.h"
#include "render/picture.h"

namespace wobblebench::hw {
class PolarVolume;
}

namespace wobblebench::render {

/// Inputs and outputs of render_volume(), without pass times. Throws InvalidOption.
///
/// @code
/// #include "hw/probe/polar_volume.h"
/// const hw::PolarVolume volume(hw::AcquisitionPlan({}, {}));
/// render::RenderOptions options;
/// options.ray_casting.image_size = 64;
/// const render::Picture picture = render::render_reference(volume, options);
/// const render::Picture shaded = render::shade_depth(picture.depth_m, options);
/// @endcode
Picture render_reference(const hw::PolarVolume& volume, const RenderOptions& options);

/// Passes 3 and 4 on any depth image, such as the ground truth, of image_size pixels per side.
/// `rendered`: the volume picture, which ShadingBase::rendered shades; black if empty. Throws
/// InvalidOption.
Picture shade_depth(const Image<float>& depth_m,
                    const RenderOptions& options,
                    const Image<glm::vec3>& rendered = {});

}  // namespace wobblebench::render
