// Reading mesh files, by Assimp.
#pragma once

#include <filesystem>
#include <string>

#include "phantoms/io/triangle_mesh.h"

namespace wobblebench::phantoms {

/// Such as ".stl", in lower case.
std::string lower_case_extension(const std::filesystem::path& path);

/// All triangles of all meshes of the file, in its unit; polygons are triangulated, points and
/// lines dropped. Throws std::invalid_argument with one line for a file that is not readable in the
/// format of its extension, has no triangles, or has vertices that are not finite.
[[nodiscard]] TriangleMesh read_mesh(const std::filesystem::path& path);

}  // namespace wobblebench::phantoms
