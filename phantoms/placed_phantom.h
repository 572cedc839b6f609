// A phantom in front of the probe: its position, orientation and motion.
#pragma once

#include <glm/vec3.hpp>

#include "phantoms/motion.h"
#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

/// What a probe scans. Cheap to copy: copies share the phantom's grids. Without placement and
/// motion the phantom's origin is that of the probe frame, and nothing moves.
///
/// @code
/// #include <cstdio>
///
/// const phantoms::Phantom ball = phantoms::make_phantom({.name = "sphere"});
/// phantoms::PlacedPhantom scanned = phantoms::still_at(ball, {0, 0, 0.11});
/// scanned.motion = phantoms::Motion({.velocity_m_s = {5e-3, 0, 0}}, ball.joint());
/// const glm::dvec3 centre_m = scanned.from_rest({0, 0, 0}, 0.2);  // probe frame, after 0.2 s
/// std::printf("centre at x = %g m\n", centre_m.x);  // 0.001
/// @endcode
struct PlacedPhantom {
  Phantom phantom;
  Placement placement = {};
  Motion motion = {};

  /// Transforms from the probe frame at a time (seconds of device time) to the phantom frame at
  /// rest, and back.
  glm::dvec3 to_rest(const glm::dvec3& probe_m, double time_s) const {
    return motion.to_rest(placement.to_phantom(probe_m), time_s);
  }
  glm::dvec3 from_rest(const glm::dvec3& rest_m, double time_s) const {
    return placement.to_probe(motion.from_rest(rest_m, time_s));
  }
};

/// The phantom's origin at a position in the probe frame, not rotated, at rest.
inline PlacedPhantom still_at(const Phantom& phantom, const glm::dvec3& position_m) {
  return {phantom, {glm::dmat3(1.0), position_m}};
}

}  // namespace wobblebench::phantoms
