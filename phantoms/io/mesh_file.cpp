#include "phantoms/io/mesh_file.h"

#include <cmath>
#include <cstring>
#include <stdexcept>

#include "phantoms/io/import_process.h"
#include "phantoms/io/message.h"

namespace wobblebench::phantoms {
namespace {

std::vector<glm::dvec3> read_vertices(MessageReader& in) {
  std::vector<glm::dvec3> vertices;
  for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
    const auto at = in.get<std::array<double, 3>>();
    if (!std::isfinite(at[0]) || !std::isfinite(at[1]) || !std::isfinite(at[2])) {
      throw std::invalid_argument("holds a vertex that is not finite");
    }
    vertices.emplace_back(at[0], at[1], at[2]);
  }
  return vertices;
}

std::vector<TriangleMesh::Triangle> read_triangles(MessageReader& in, std::size_t vertices) {
  using Triangle = TriangleMesh::Triangle;
  const std::string_view bytes = in.list<Triangle>();
  std::vector<Triangle> triangles(bytes.size() / sizeof(Triangle));
  if (triangles.empty()) throw std::invalid_argument("has no triangles");
  std::memcpy(triangles.data(), bytes.data(), bytes.size());
  for (const Triangle& triangle : triangles) {
    for (const std::uint32_t corner : triangle) {
      if (corner >= vertices) throw std::invalid_argument("has a face without its vertices");
    }
  }
  return triangles;
}

}  // namespace

TriangleMesh read_mesh(const std::filesystem::path& path) {
  return mesh_from_message(ImportedBytes(ImportFormat::mesh, path).message());
}

TriangleMesh mesh_from_message(std::string_view message) {
  MessageReader in(message);
  TriangleMesh mesh;
  mesh.vertices = read_vertices(in);
  mesh.triangles = read_triangles(in, mesh.vertices.size());
  return mesh;
}

}  // namespace wobblebench::phantoms
