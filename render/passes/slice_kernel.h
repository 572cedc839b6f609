// The part of pass 1's and pass 2's filters that works on slices. Shared with the reference, since
// it defines the picture.
#pragma once

#include <vector>

#include "render/options.h"

namespace wobblebench::render {

/// Taps within a slice, along each axis: pass 1's box, convolved with the Gaussian of the 3D kernel
/// where that lies in slices. Odd length, sum 1. A slice's pixel is the mean, weighted by the
/// product of two taps, of the pixels around it that hold data.
std::vector<double> slice_weights(const RenderOptions& options);

/// Taps across frames: the Gaussian of the 3D kernel where that lies in slices, else a lone 1. Taps
/// beyond the first and last frame carry no weight.
std::vector<double> frame_weights(const RayCastingOptions& options);

/// Taps a side of the part of the 3D kernel that lies along the ray and across it; 1: none.
int ray_kernel_size(const RayCastingOptions& options);

}  // namespace wobblebench::render
