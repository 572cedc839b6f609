// A coarse triangle mesh of a phantom's surface, for drawing.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

struct SurfaceMesh {
  std::vector<glm::dvec3> points_m;                     ///< phantom frame, at rest
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< corners, as indices of points
};

/// Of Phantom::surfaces()[surface], by OpenVDB's volumeToMesh on cubes of which `edges` lie along
/// its longest side, or on its own voxels where those are larger. Parts thinner than a cube may be
/// missing. Empty where the surface is.
SurfaceMesh surface_mesh(const Phantom& phantom, std::size_t surface, double edges);

}  // namespace wobblebench::phantoms
