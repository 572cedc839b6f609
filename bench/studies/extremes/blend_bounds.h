// How far the blended picture of pass 2 may be from the reference's.
#pragma once

#include "base/image.h"
#include "bench/studies/extremes/pass_bounds.h"

namespace wobblebench::bench {

/// Of each pixel, full scales. Samples are exchanged for wrong ones one after the other along the
/// reference's ray: each changes the picture by the light that reaches it times the error of its
/// opacity and grey level. Those follow from the transfer function within the sample's bound.
Image<double> blend_bounds(const render::reference::SliceStack& slices,
                           const render::RenderOptions& options,
                           const PassBounds& bounds);

}  // namespace wobblebench::bench
