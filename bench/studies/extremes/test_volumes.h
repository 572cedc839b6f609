// Volumes in closed form: a ball in noise, scaled to the cone of its plan; and what a change of one
// of their samples may change.
#pragma once

#include <vector>

#include "base/image.h"
#include "bench/studies/extremes/extreme_cases.h"
#include "hw/probe/polar_volume.h"
#include "render/options.h"

namespace wobblebench::bench {

/// Soft-edged, on the axis at 0.55 of the depth, a quarter of the depth in radius; 0.9 inside and
/// 0.1 outside, with uniform noise of 0.05.
hw::PolarVolume ball_volume(const hw::AcquisitionPlan& plan);

/// A volume with the change of a case, where one sample is that at which the axis enters the ball;
/// and the same with samples in [0, 1] that mean the same by what the renderer promises: NaN,
/// infinities and negative numbers are 0, the rest is clamped.
struct ChangedVolume {
  hw::PolarVolume given, meant;
};
ChangedVolume changed_volume(const hw::PolarVolume& volume, SampleChange change);

/// [row * image_size + column]: whether the pixel's ray, or one a quarter of a pixel beside it,
/// comes to where the double-precision reference reads other samples of one volume than of the
/// other. With a level that the volume says, a sample moves all others a little: they count as
/// other samples where they differ by a thousandth of full scale.
std::vector<bool> reached_pixels(const hw::PolarVolume& before,
                                 const hw::PolarVolume& after,
                                 const render::RenderOptions& options);

/// Pixels out of reach whose z differs; with a level that the volume says, by more than a hundredth
/// of a step.
long changed_out_of_reach(const std::vector<bool>& reached,
                          const Image<float>& before_m,
                          const Image<float>& after_m,
                          const render::RenderOptions& options);

}  // namespace wobblebench::bench
