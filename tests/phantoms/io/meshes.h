// Small meshes, and functions that write them to files, for the tests of the import.
#pragma once

#include <filesystem>
#include <string>

#include "phantoms/io/triangle_mesh.h"

namespace wobblebench::phantoms {

/// Corners (0,0,0), (side,0,0), (0,side,0), (0,0,side); volume side^3 / 6.
TriangleMesh tetrahedron(double side);
/// From -side/2 to side/2.
TriangleMesh cube_mesh(double side);
/// An icosahedron of this circumscribed radius, its triangles subdivided into four `rounds` times.
TriangleMesh icosphere(double radius, int rounds);

TriangleMesh moved(TriangleMesh mesh, const glm::dvec3& by);
TriangleMesh inverted(TriangleMesh mesh);
TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b);

void write_obj(const TriangleMesh& mesh, const std::filesystem::path& path);
void write_ascii_stl(const TriangleMesh& mesh, const std::filesystem::path& path);
void write_binary_stl(const TriangleMesh& mesh, const std::filesystem::path& path);
void write_ascii_ply(const TriangleMesh& mesh, const std::filesystem::path& path);
void write_binary_ply(const TriangleMesh& mesh, const std::filesystem::path& path);

}  // namespace wobblebench::phantoms
