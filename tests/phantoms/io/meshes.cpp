#include "tests/phantoms/io/meshes.h"

#include <array>
#include <bit>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <utility>

namespace wobblebench::phantoms {
namespace {

std::ofstream opened(const std::filesystem::path& path) {
  std::ofstream out(path, std::ios::binary);
  out.precision(std::numeric_limits<float>::max_digits10);
  return out;
}

template <class T>
void put(std::ofstream& out, T value) {
  const auto bytes = std::bit_cast<std::array<char, sizeof value>>(value);
  out.write(bytes.data(), bytes.size());
}

void put(std::ofstream& out, const glm::dvec3& v) {
  for (int axis = 0; axis < 3; ++axis) put(out, float(v[axis]));
}

void write_ply_header(std::ofstream& out, const TriangleMesh& mesh, const std::string& format) {
  out << "ply\nformat " << format << " 1.0\nelement vertex " << mesh.vertices.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
      << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
}

}  // namespace

TriangleMesh tetrahedron(double side) {
  return {{{0, 0, 0}, {side, 0, 0}, {0, side, 0}, {0, 0, side}},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

TriangleMesh cube_mesh(double side) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.vertices.push_back(
        side * glm::dvec3((corner & 1) - 0.5, (corner >> 1 & 1) - 0.5, (corner >> 2) - 0.5));
  }
  mesh.triangles = {{0, 2, 1},
                    {1, 2, 3},
                    {4, 5, 6},
                    {5, 7, 6},
                    {0, 1, 4},
                    {1, 5, 4},
                    {2, 6, 3},
                    {3, 6, 7},
                    {0, 4, 2},
                    {2, 4, 6},
                    {1, 3, 5},
                    {3, 7, 5}};
  return mesh;
}

TriangleMesh icosphere(double radius, int rounds) {
  const double t = (1 + std::sqrt(5.0)) / 2;
  TriangleMesh mesh{
      {{-1, t, 0},
       {1, t, 0},
       {-1, -t, 0},
       {1, -t, 0},
       {0, -1, t},
       {0, 1, t},
       {0, -1, -t},
       {0, 1, -t},
       {t, 0, -1},
       {t, 0, 1},
       {-t, 0, -1},
       {-t, 0, 1}},
      {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
       {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
       {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  for (int round = 0; round < rounds; ++round) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, is_new] = middles.try_emplace({std::min(a, b), std::max(a, b)},
                                                       std::uint32_t(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back(0.5 * (mesh.vertices[a] + mesh.vertices[b]));
      return entry->second;
    };
    std::vector<TriangleMesh::Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = finer;
    for (glm::dvec3& v : mesh.vertices) v = glm::normalize(v);
  }
  for (glm::dvec3& v : mesh.vertices) v = radius * glm::normalize(v);
  return mesh;
}

TriangleMesh moved(TriangleMesh mesh, const glm::dvec3& by) {
  for (glm::dvec3& vertex : mesh.vertices) vertex += by;
  return mesh;
}

TriangleMesh inverted(TriangleMesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh both = a;
  const auto first = std::uint32_t(a.vertices.size());
  both.vertices.insert(both.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) {
    both.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return both;
}

void write_obj(const TriangleMesh& mesh, const std::filesystem::path& path) {
  auto out = opened(path);
  for (const glm::dvec3& v : mesh.vertices) out << "v " << v.x << " " << v.y << " " << v.z << "\n";
  for (const auto& t : mesh.triangles) {
    out << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
  }
}

void write_ascii_stl(const TriangleMesh& mesh, const std::filesystem::path& path) {
  auto out = opened(path);
  out << "solid body\n";
  for (const auto& t : mesh.triangles) {
    out << "facet normal 0 0 0\n outer loop\n";
    for (const std::uint32_t corner : t) {
      const glm::dvec3& v = mesh.vertices[corner];
      out << "  vertex " << v.x << " " << v.y << " " << v.z << "\n";
    }
    out << " endloop\nendfacet\n";
  }
  out << "endsolid body\n";
}

void write_binary_stl(const TriangleMesh& mesh, const std::filesystem::path& path) {
  auto out = opened(path);
  out << std::string(80, ' ');
  put(out, std::uint32_t(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    put(out, glm::dvec3(0));
    for (const std::uint32_t corner : t) put(out, mesh.vertices[corner]);
    put(out, std::uint16_t(0));
  }
}

void write_ascii_ply(const TriangleMesh& mesh, const std::filesystem::path& path) {
  auto out = opened(path);
  write_ply_header(out, mesh, "ascii");
  for (const glm::dvec3& v : mesh.vertices) out << v.x << " " << v.y << " " << v.z << "\n";
  for (const auto& t : mesh.triangles) out << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
}

void write_binary_ply(const TriangleMesh& mesh, const std::filesystem::path& path) {
  auto out = opened(path);
  write_ply_header(out, mesh, "binary_little_endian");
  for (const glm::dvec3& v : mesh.vertices) put(out, v);
  for (const auto& t : mesh.triangles) {
    put(out, std::uint8_t(3));
    for (const std::uint32_t corner : t) put(out, std::int32_t(corner));
  }
}

}  // namespace wobblebench::phantoms
