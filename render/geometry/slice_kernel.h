// How the 3D kernel of pass 2 splits into filters of slices, of frames, and along the ray, for the
// GL passes and the double-precision reference.
#pragma once

#include <vector>

#include "render/options.h"

namespace wobblebench::render {

/// Taps within a slice, along each axis: pass 1's box, convolved with the Gaussian of the 3D kernel
/// if that lies in slices. Odd length, sum 1. A pixel of a slice is the mean of the pixels around
/// it that hold data, weighted by the product of the taps of both axes.
std::vector<double> slice_weights(const RenderOptions& options);

/// Taps across frames: the Gaussian of the 3D kernel if that lies in slices, else a single 1. Taps
/// beyond the first and last frame carry no weight.
std::vector<double> frame_weights(const RayCastingOptions& options);

/// Taps per side of the 3D kernel in ray space; 1: none.
int ray_kernel_size(const RayCastingOptions& options);

}  // namespace wobblebench::render
