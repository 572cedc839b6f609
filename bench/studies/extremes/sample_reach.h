// Which pixels of pass 2 a single sample of a volume may change.
#pragma once

#include <vector>

#include "base/image.h"
#include "bench/studies/extremes/test_volumes.h"
#include "render/options.h"

namespace wobblebench::bench {

/// [row * image_size + column]: the pixel's ray comes to where interpolation, slice filter and
/// kernels read the sample; with aligned sticks, any sample of the sticks that share its
/// neighbourhood (decision 31). In closed form, not by the renderer.
std::vector<bool> reached_pixels(const hw::AcquisitionPlan& plan,
                                 const render::RenderOptions& options,
                                 const ChangedSample& changed);

/// Pixels out of reach whose z differs. With aligned sticks or a detector that
/// measures its level, one sample moves the level of all pixels: by that z may move a hundredth of
/// a step.
long changed_out_of_reach(const std::vector<bool>& reached,
                          const Image<float>& before_m,
                          const Image<float>& after_m,
                          const render::RenderOptions& options);

}  // namespace wobblebench::bench
