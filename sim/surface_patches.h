// Finds out what a small cube of tissue holds: one material, one surface as a parabola, or more.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>

#include "sim/tissue_map.h"

namespace wobblebench::sim {

/// A cube at rest.
struct Cube {
  glm::dvec3 center_m{0};
  double side_m = 0;
};

/// A parabola of the place in the cube, x, y, z from -1 to 1: at + b . r + sum of q r r.
struct Parabola {
  double at = 0;
  glm::dvec3 slope{0};
  glm::dvec3 square{0};   ///< xx, yy, zz
  glm::dvec3 product{0};  ///< xy, yz, xz
};

/// One surface in a cube.
struct CutCube {
  Parabola distance;
  phantoms::MaterialIndex inside = 0;  ///< where the distance is negative
  phantoms::MaterialIndex outside = 0;
};

/// The same for many scatterers: signed distance over x, y, z from -1 to 1 across a hash cell,
///   at + x (bx + qxx x + qxy y) + y (by + qyy y + qyz z) + z (bz + qzz z + qxz x)
/// and how the tissue on its two sides echoes.
struct SurfacePatch {
  float at = 0;
  float bx = 0, by = 0, bz = 0;
  float qxx = 0, qyy = 0, qzz = 0;
  float qxy = 0, qyz = 0, qxz = 0;
  float inside_amplitude = 0;  ///< where the distance is negative
  float outside_amplitude = 0;
  std::int16_t inside = 0;  ///< materials
  std::int16_t outside = 0;
};

/// What a cube holds, if it is simple: one material, or one surface.
struct CubeTissue {
  std::optional<phantoms::MaterialIndex> material;
  std::optional<CutCube> cut;
};

/// The material of all of a cube and of what is within `margin_m` of its surfaces, if it is one.
std::optional<phantoms::MaterialIndex> one_material(const TissueMap& map,
                                                    const Cube& cube,
                                                    double margin_m);

/// The same; if it is not, samples the cube's centre, the middles of its faces and its corners.
/// Neither is known if several surfaces pass nearby, or one that a parabola does not meet within 30
/// um at all of these.
CubeTissue study_cube(const TissueMap& map, const Cube& cube, double margin_m);

}  // namespace wobblebench::sim
