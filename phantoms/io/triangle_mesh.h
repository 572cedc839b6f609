// Triangle meshes: files, read by wobblebench-import; welding, closedness, orientation, volume and
// area.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

/// The vertices of a triangle are counter-clockwise as seen from outside.
struct TriangleMesh {
  using Triangle = std::array<std::uint32_t, 3>;
  std::vector<glm::dvec3> vertices;
  std::vector<Triangle> triangles;
};

/// All triangles of all meshes of the file, in its unit; polygons are triangulated, points and
/// lines dropped. Throws std::invalid_argument with one line for a file that is not readable in the
/// format of its extension, has no triangles, ends its reader, or has vertices that are not finite;
/// ImportUnavailable where there is no reader.
[[nodiscard]] TriangleMesh read_mesh(const std::filesystem::path& path);

/// The mesh of a message, of which nothing is trusted. Throws std::invalid_argument.
[[nodiscard]] TriangleMesh mesh_from_message(std::string_view message);

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

/// Such as ".stl", in lower case.
inline std::string lower_case_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  return extension;
}

}  // namespace wobblebench::phantoms
