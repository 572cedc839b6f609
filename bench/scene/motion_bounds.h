// Bounds of a phantom's motion: speed, stretch, and the region at rest.
#pragma once

#include "phantoms/motion.h"
#include "phantoms/phantom.h"

namespace wobblebench::bench {

/// Sampled in space and time, with a margin for motion between the samples; of a mouth in closed
/// form.
struct MotionBounds {
  double speed_m_s = 0;   ///< of the position at rest of a fixed point
  double stretch = 1;     ///< distance at rest over the distance now of two points
  phantoms::Box at_rest;  ///< holds the positions at rest of all points of the box
};

/// For points in `box` (phantom frame) from time `begin_s` to `end_s`.
MotionBounds motion_bounds(const phantoms::Motion& motion,
                           const phantoms::Box& box,
                           double begin_s,
                           double end_s);

}  // namespace wobblebench::bench
