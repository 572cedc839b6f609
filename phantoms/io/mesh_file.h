// Mesh files, read by wobblebench-import.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "phantoms/io/triangle_mesh.h"

namespace wobblebench::phantoms {

/// Such as ".stl", in lower case.
inline std::string lower_case_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  return extension;
}

/// All triangles of all meshes of the file, in its unit; polygons are triangulated, points and
/// lines dropped. Throws std::invalid_argument with one line for a file that is not readable in the
/// format of its extension, has no triangles, ends its reader, or has vertices that are not finite;
/// ImportUnavailable where there is no reader.
[[nodiscard]] TriangleMesh read_mesh(const std::filesystem::path& path);

/// The mesh of a message, of which nothing is trusted. Throws std::invalid_argument.
[[nodiscard]] TriangleMesh mesh_from_message(std::string_view message);

}  // namespace wobblebench::phantoms
