// What faces the probe behind fluid: the first surface of each stick beyond the wall of the womb.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "hw/probe/polar_volume.h"

namespace wobblebench::bench {

/// A connected piece of the surface.
struct SurfaceIsland {
  std::vector<glm::dvec3> points;
  /// Share of its rim, stick by stick, beyond which nothing lies or what lies farther away: 1 of a
  /// body in fluid, less of a wall.
  double free_rim = 0;
};

/// Sticks are [frame * lines + line].
struct FacingSurface {
  std::vector<hw::Ray> sticks;
  std::vector<double> edge_m;     ///< range of the first surface behind fluid; NaN: there is none
  std::vector<glm::dvec3> fluid;  ///< points before it, 8 mm apart along a stick
  std::vector<SurfaceIsland> islands;
};

/// By the edges of render/reconstruction/stick_edges.h, half the way from fluid to tissue.
FacingSurface find_facing_surface(const hw::AcquisitionPlan& plan,
                                  const std::vector<hw::PolarFrame>& frames);

}  // namespace wobblebench::bench
