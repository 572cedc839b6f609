// How far and how fast a phantom's motion may take tissue.
#pragma once

#include "phantoms/motion.h"
#include "phantoms/phantom.h"

namespace wobblebench::bench {

/// Found by sampling, with a margin; what moves by less between samples than the margin covers is
/// covered.
struct MotionBounds {
  double speed_m_s = 0;   ///< of the place at rest that a fixed place shows
  double stretch = 1;     ///< distance between places at rest over that between places now
  phantoms::Box at_rest;  ///< holds the places at rest that are shown
};

/// For places in `box` (phantom frame) from time 0 to `duration_s`.
MotionBounds motion_bounds(const phantoms::Motion& motion,
                           const phantoms::Box& box,
                           double duration_s);

}  // namespace wobblebench::bench
