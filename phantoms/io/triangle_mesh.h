// Triangle meshes: welding, closedness, orientation, volume and area.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

/// The vertices of a triangle are counter-clockwise as seen from outside.
struct TriangleMesh {
  using Triangle = std::array<std::uint32_t, 3>;
  std::vector<glm::dvec3> vertices;
  std::vector<Triangle> triangles;
};

/// Merges vertices of exactly equal positions (each triangle of an STL has its own), and drops
/// triangles with two equal corners.
TriangleMesh welded(const TriangleMesh& mesh);

/// Edges that keep a welded mesh from being a closed, oriented surface.
struct EdgeFaults {
  std::size_t open = 0;      ///< edges of only one triangle
  std::size_t crowded = 0;   ///< edges of more than two
  std::size_t opposite = 0;  ///< edges whose two triangles are oriented oppositely
};
EdgeFaults edge_faults(const TriangleMesh& mesh);

/// Volumes of the connected shells in m^3, negative where a shell's triangles face inwards.
std::vector<double> shell_volumes(const TriangleMesh& mesh);

double surface_area(const TriangleMesh& mesh);
/// Bounding box of all triangles; vertices of no triangle are ignored.
Box bounds(const TriangleMesh& mesh);

}  // namespace wobblebench::phantoms
