// Cuts the faces of imported meshes into triangles.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "phantoms/io/triangle_mesh.h"

namespace wobblebench::phantoms {

/// Triangles of a face, as positions in the list of its corners: they cover it once, face as it
/// does, and have its edges. The outline may be concave, bend out of its plane, have corners on a
/// straight line or twice, and join holes by edges that run both ways. Throws std::invalid_argument
/// for one that crosses itself, or touches itself between two corners.
[[nodiscard]] std::vector<TriangleMesh::Triangle> cut_polygon(std::span<const glm::dvec3> corners);

/// Adds the triangles of a face of three or more corners, which are positions in `mesh.vertices`.
void add_face(TriangleMesh& mesh, std::span<const std::uint32_t> corners);

}  // namespace wobblebench::phantoms
