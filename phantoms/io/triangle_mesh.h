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

/// The same of a file whose vertices may belong to no triangle: a cloud of points, of which some
/// may not be finite.
[[nodiscard]] TriangleMesh read_mesh_or_points(const std::filesystem::path& path);

/// The mesh of a message, of which nothing is trusted. Throws std::invalid_argument.
[[nodiscard]] TriangleMesh mesh_from_message(std::string_view message);

/// Merges vertices of exactly equal positions (each triangle of an STL has its own), and drops
/// triangles with two equal corners.
TriangleMesh welded(const TriangleMesh& mesh);

/// Merges vertices at most two units in the last place of a float apart, at the largest coordinate:
/// corners that a program computed anew for each triangle. Drops triangles with two equal corners.
TriangleMesh welded_but_for_rounding(const TriangleMesh& mesh);

/// Edges that keep a welded mesh from being a closed, oriented surface.
struct EdgeFaults {
  std::size_t open = 0;      ///< edges of only one triangle
  std::size_t crowded = 0;   ///< edges of more than two
  std::size_t opposite = 0;  ///< edges whose two triangles are oriented oppositely
};
EdgeFaults edge_faults(const TriangleMesh& mesh);

/// A connected part of a welded mesh.
struct Shell {
  std::vector<TriangleMesh::Triangle> triangles;
  double volume = 0;  ///< negative where the triangles face inwards
  int depth = 0;      ///< number of shells that it lies within
};
[[nodiscard]] std::vector<Shell> shells_of(const TriangleMesh& mesh);

/// What the triangles enclose, less what those that face inwards do.
double enclosed_volume(const std::vector<Shell>& shells);

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
