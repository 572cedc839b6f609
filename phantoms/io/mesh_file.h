// Meshes from disk, through Assimp.
#pragma once

#include <filesystem>
#include <string>

#include "phantoms/io/triangle_mesh.h"

namespace wobblebench::phantoms {

/// As ".stl", whatever the case of the letters.
std::string lower_case_extension(const std::filesystem::path& path);

/// All triangles of all meshes of the file, in its unit, its polygons cut into triangles, points
/// and lines left out. Throws std::invalid_argument with one line for what is not readable as its
/// extension says, has no triangles, or has vertices that are not finite.
TriangleMesh read_mesh(const std::filesystem::path& path);

}  // namespace wobblebench::phantoms
