#include "phantoms/io/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "phantoms/io/import_process.h"
#include "phantoms/io/message.h"

namespace wobblebench::phantoms {
namespace {

using Triangle = TriangleMesh::Triangle;

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

std::vector<Triangle> read_triangles(MessageReader& in, std::size_t vertices) {
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

bool is_less(const glm::dvec3& a, const glm::dvec3& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

// Six times the volume of the cone from `apex` to the triangle.
double cone6(const TriangleMesh& mesh, const Triangle& t, const glm::dvec3& apex) {
  const glm::dvec3 a = mesh.vertices[t[0]] - apex, b = mesh.vertices[t[1]] - apex,
                   c = mesh.vertices[t[2]] - apex;
  return glm::dot(a, glm::cross(b, c));
}

// Union-find over the vertices: those of one shell form one set.
class Shells {
 public:
  explicit Shells(std::size_t vertices) : parent_(vertices) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  std::uint32_t root(std::uint32_t vertex) {
    while (parent_[vertex] != vertex) {
      parent_[vertex] = parent_[parent_[vertex]];
      vertex = parent_[vertex];
    }
    return vertex;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[root(a)] = root(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

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

TriangleMesh welded(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return is_less(mesh.vertices[a], mesh.vertices[b]);
  });
  TriangleMesh result;
  std::vector<std::uint32_t> merged(mesh.vertices.size());
  for (const std::uint32_t vertex : order) {
    if (result.vertices.empty() || result.vertices.back() != mesh.vertices[vertex]) {
      result.vertices.push_back(mesh.vertices[vertex]);
    }
    merged[vertex] = std::uint32_t(result.vertices.size() - 1);
  }
  for (const Triangle& t : mesh.triangles) {
    const Triangle at{merged[t[0]], merged[t[1]], merged[t[2]]};
    if (at[0] != at[1] && at[1] != at[2] && at[2] != at[0]) result.triangles.push_back(at);
  }
  return result;
}

EdgeFaults edge_faults(const TriangleMesh& mesh) {
  // Both ends, the lower first, and whether the triangle goes from the lower to the higher.
  using Edge = std::tuple<std::uint32_t, std::uint32_t, bool>;
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t from = t[corner], to = t[(corner + 1) % 3];
      edges.emplace_back(std::min(from, to), std::max(from, to), from < to);
    }
  }
  std::sort(edges.begin(), edges.end());
  EdgeFaults faults;
  for (std::size_t first = 0; first < edges.size();) {
    std::size_t last = first, upwards = 0;
    const auto ends = [&](std::size_t i) {
      return std::pair(std::get<0>(edges[i]), std::get<1>(edges[i]));
    };
    for (; last < edges.size() && ends(last) == ends(first); ++last) {
      upwards += std::get<2>(edges[last]);
    }
    const std::size_t count = last - first;
    faults.open += count == 1;
    faults.crowded += count > 2;
    faults.opposite += count == 2 && upwards != 1;
    first = last;
  }
  return faults;
}

std::vector<double> shell_volumes(const TriangleMesh& mesh) {
  Shells shells(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    shells.join(t[0], t[1]);
    shells.join(t[1], t[2]);
  }
  std::vector<double> by_root(mesh.vertices.size(), 0.0);
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const Triangle& t : mesh.triangles) {
    const std::uint32_t root = shells.root(t[0]);
    // The apex is a vertex of the shell: a distant one would cost precision.
    by_root[root] += cone6(mesh, t, mesh.vertices[root]) / 6;
    used[root] = true;
  }
  std::vector<double> volumes;
  for (std::size_t i = 0; i < by_root.size(); ++i) {
    if (used[i]) volumes.push_back(by_root[i]);
  }
  return volumes;
}

double surface_area(const TriangleMesh& mesh) {
  double area = 0;
  for (const Triangle& t : mesh.triangles) {
    const glm::dvec3& a = mesh.vertices[t[0]];
    area += 0.5 * glm::length(glm::cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a));
  }
  return area;
}

Box bounds(const TriangleMesh& mesh) {
  const glm::dvec3& first = mesh.vertices.at(mesh.triangles.at(0)[0]);
  Box box{first, first};
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t corner : t) {
      const glm::dvec3& vertex = mesh.vertices[corner];
      box = {glm::min(box.low, vertex), glm::max(box.high, vertex)};
    }
  }
  return box;
}

}  // namespace wobblebench::phantoms
