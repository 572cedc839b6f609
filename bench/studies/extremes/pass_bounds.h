// How far a pass in float32 and 8 or 16 bits may be from the same in double precision, derived from
// its arithmetic: nothing here is measured on the renderer. `u` is the unit roundoff of float32,
// 2^-24. A result of k rounded operations is within k u of the greatest intermediate value.
#pragma once

#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "render/options.h"
#include "render/reference/reference_passes.h"

namespace wobblebench::bench {

/// Greatest difference between neighbours: what an error of place is worth in full scales.
struct Steepness {
  double line = 0, sample = 0;            ///< of the sticks
  double column = 0, row = 0, frame = 0;  ///< of the reference's slices
};
Steepness steepness(const hw::PolarVolume& volume,
                    const render::reference::SliceStack& slices,
                    const render::RenderOptions& options);

struct PassBounds {
  double slices = 0;        ///< of a slice's pixel, full scales
  double sample = 0;        ///< of a sample that a ray reads, full scales
  double detector = 0;      ///< of what the detector compares with its threshold, full scales
  double position_m = 0;    ///< of a position in the probe frame
  double place_m = 0;       ///< of a ray's sample against the cone: position and motor angle
  double step_error_m = 0;  ///< of z beside the detector's
  double filter = 0;        ///< of the z filter, of z
  double smoothing = 0;     ///< of pass 4
};

/// How each follows is said in pass_bounds.cpp, and in the report. Infinite where a scan's motor
/// axis lies among the samples of a ray: there a frame's number has no bounded slope.
PassBounds pass_bounds(const hw::AcquisitionPlan& plan,
                       const render::RenderOptions& options,
                       const Steepness& steepness);

/// 2^-24.
inline constexpr double kUnitRoundoff = 1.0 / (1 << 24);

}  // namespace wobblebench::bench
