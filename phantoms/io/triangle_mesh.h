// Triangles as they come from a file, and whether they enclose a body.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

/// Seen from outside, the vertices of a triangle go round counter-clockwise.
struct TriangleMesh {
  using Triangle = std::array<std::uint32_t, 3>;
  std::vector<glm::dvec3> vertices;
  std::vector<Triangle> triangles;
};

/// Makes one vertex of those at exactly the same place (each triangle of an STL brings its own),
/// and drops triangles that two equal corners leave without an area.
TriangleMesh welded(const TriangleMesh& mesh);

/// What keeps a welded mesh from being a closed surface.
struct EdgeFaults {
  std::size_t open = 0;      ///< edges of one triangle alone
  std::size_t crowded = 0;   ///< edges of more than two
  std::size_t opposite = 0;  ///< edges whose two triangles face opposite ways
};
EdgeFaults edge_faults(const TriangleMesh& mesh);

/// Volumes of the connected shells in m^3, negative where a shell's triangles face inwards.
std::vector<double> shell_volumes(const TriangleMesh& mesh);

double surface_area(const TriangleMesh& mesh);
/// Holds all triangles; vertices of none do not count.
Box bounds(const TriangleMesh& mesh);

}  // namespace wobblebench::phantoms
