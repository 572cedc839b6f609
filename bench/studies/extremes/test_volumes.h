// Volumes in closed form: a ball in noise, scaled to the cone of its plan.
#pragma once

#include "bench/studies/extremes/extreme_cases.h"
#include "hw/probe/polar_volume.h"

namespace wobblebench::bench {

/// Soft-edged, on the axis at 0.55 of the depth, a quarter of the depth in radius; 0.9 inside and
/// 0.1 outside, with uniform noise of 0.05.
hw::PolarVolume ball_volume(const hw::AcquisitionPlan& plan);

/// The stick and sample that a change of one sample is made to: where the axis enters the ball.
struct ChangedSample {
  hw::StickIndex stick;
  int sample = 0;
};
ChangedSample changed_sample(const hw::AcquisitionPlan& plan);

/// A volume with the change of a case, and the same with samples in [0, 1] that mean the same by
/// what the renderer promises: NaN, infinities and negative numbers are 0, the rest is clamped.
struct ChangedVolume {
  hw::PolarVolume given, meant;
};
ChangedVolume changed_volume(const hw::PolarVolume& volume, SampleChange change);

}  // namespace wobblebench::bench
