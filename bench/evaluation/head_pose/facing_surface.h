// What faces the probe behind fluid: the first surface of each stick beyond the wall of the womb.
#pragma once

#include <cstddef>
#include <vector>

#include "hw/probe/polar_volume.h"

namespace wobblebench::bench {

/// A connected piece of the surface.
struct SurfaceIsland {
  std::vector<std::size_t> sticks;
  /// Share of its rim, stick by stick, beyond which nothing lies or what lies farther away: 1 of a
  /// body in fluid, less of a wall.
  double free_rim = 0;
};

/// [frame * lines + line]; ranges in m, NaN where there is none.
struct FacingSurface {
  std::vector<hw::Ray> sticks;
  std::vector<double> fluid_m;  ///< where the first 10 mm of fluid are passed by half
  std::vector<double> edge_m;   ///< of the first surface behind it
  std::vector<SurfaceIsland> islands;

  glm::dvec3 point(std::size_t stick) const { return sticks[stick].at(edge_m[stick]); }
};

/// By the edges of render/reconstruction/stick_edges.h, half the way from fluid to tissue.
FacingSurface find_facing_surface(const hw::PolarVolume& volume);

}  // namespace wobblebench::bench
