// One stick's input to the scatterer rungs, and point scatterers.
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "sim/tissue/timed_ray.h"

namespace wobblebench::sim {

/// Propagation along a stick's axis, one value for each IQ sample; sample i lies at apparent range
/// (i + 1/2) * spacing_m.
struct StickPath {
  TimedRay line;
  double spacing_m = 0;  ///< of the plan's IQ samples (sim/speckle/iq_field.h)
  /// Two-way amplitude that remains after losses; samples from remaining.size() on are lost.
  std::span<const float> remaining;
  /// Apparent less true range; empty: 0 everywhere (one sound speed).
  std::span<const float> delay_m;
  /// Centre frequency of the pulse over the probe's; empty: 1 everywhere (nothing absorbs).
  std::span<const float> frequency_ratio = {};
};

/// A point scatterer at one moment.
struct PointEcho {
  glm::dvec3 position_m{0};  ///< probe frame
  float amplitude = 0;       ///< of the echo that it would have on the axis at its range
};

}  // namespace wobblebench::sim
