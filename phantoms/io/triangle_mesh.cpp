#include "phantoms/io/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "phantoms/io/import_process.h"
#include "phantoms/io/message.h"

namespace wobblebench::phantoms {
namespace {

using Triangle = TriangleMesh::Triangle;

std::vector<glm::dvec3> read_vertices(MessageReader& in) {
  const std::string_view bytes = in.list<glm::dvec3>();
  std::vector<glm::dvec3> vertices(bytes.size() / sizeof(glm::dvec3));
  if (!bytes.empty()) std::memcpy(vertices.data(), bytes.data(), bytes.size());
  return vertices;
}

std::vector<Triangle> read_triangles(MessageReader& in, std::size_t vertices) {
  const std::string_view bytes = in.list<Triangle>();
  std::vector<Triangle> triangles(bytes.size() / sizeof(Triangle));
  if (!bytes.empty()) std::memcpy(triangles.data(), bytes.data(), bytes.size());
  for (const Triangle& triangle : triangles) {
    for (const std::uint32_t corner : triangle) {
      if (corner >= vertices) throw std::invalid_argument("has a face without its vertices");
    }
  }
  return triangles;
}

TriangleMesh any_mesh(std::string_view message) {
  MessageReader in(message);
  TriangleMesh mesh;
  mesh.vertices = read_vertices(in);
  mesh.triangles = read_triangles(in, mesh.vertices.size());
  for (const glm::dvec3& at : mesh.vertices) {
    if (mesh.triangles.empty() || std::isfinite(at.x + at.y + at.z)) continue;
    throw std::invalid_argument("holds a vertex that is not finite");
  }
  return mesh;
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
class Connected {
 public:
  explicit Connected(std::size_t vertices) : parent_(vertices) {
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

// The triangles with new numbers of vertices, without those that have two equal corners.
std::vector<Triangle> renumbered(const std::vector<Triangle>& triangles,
                                 const std::vector<std::uint32_t>& number) {
  std::vector<Triangle> result;
  for (const Triangle& t : triangles) {
    const Triangle at{number[t[0]], number[t[1]], number[t[2]]};
    if (at[0] != at[1] && at[1] != at[2] && at[2] != at[0]) result.push_back(at);
  }
  return result;
}

// A list of vertices with a grid of cells, as wide as vertices that are merged may lie apart.
class NearbyVertices {
 public:
  NearbyVertices(double apart, std::vector<glm::dvec3>& vertices)
      : apart_(apart), vertices_(vertices) {}

  std::uint32_t find_or_add(const glm::dvec3& vertex) {
    const glm::dvec3 cell = glm::floor(vertex / apart_);
    for (int neighbour = 0; neighbour < 27; ++neighbour) {
      const glm::dvec3 step(neighbour % 3 - 1, neighbour / 3 % 3 - 1, neighbour / 9 - 1);
      const auto found = cells_.find(cell + step);
      if (found == cells_.end()) continue;
      const glm::dvec3 difference = glm::abs(vertices_[found->second] - vertex);
      if (std::max({difference.x, difference.y, difference.z}) <= apart_) return found->second;
    }
    const auto added = static_cast<std::uint32_t>(vertices_.size());
    vertices_.push_back(vertex);
    cells_.emplace(cell, added);
    return added;
  }

 private:
  struct Hash {
    std::size_t operator()(const glm::dvec3& cell) const {
      const auto part = [](double axis) { return static_cast<std::uint64_t>(std::int64_t(axis)); };
      return part(cell.x) * 73856093 ^ part(cell.y) * 19349663 ^ part(cell.z) * 83492791;
    }
  };
  double apart_;
  std::vector<glm::dvec3>& vertices_;
  std::unordered_map<glm::dvec3, std::uint32_t, Hash> cells_;
};

Box bounds_of(const TriangleMesh& mesh, const std::vector<Triangle>& triangles) {
  const glm::dvec3& first = mesh.vertices.at(triangles.at(0)[0]);
  Box box{first, first};
  for (const Triangle& t : triangles) {
    for (const std::uint32_t corner : t) {
      const glm::dvec3& vertex = mesh.vertices[corner];
      box = {glm::min(box.low, vertex), glm::max(box.high, vertex)};
    }
  }
  return box;
}

bool lies_within(const Box& inner, const Box& outer) {
  return glm::all(glm::lessThan(outer.low, inner.low)) &&
         glm::all(glm::lessThan(inner.high, outer.high));
}

// By the solid angle that the shell fills, seen from the point (van Oosterom and Strackee 1983).
bool encloses(const TriangleMesh& mesh, const Shell& shell, const glm::dvec3& point) {
  double half_angles = 0;
  for (const Triangle& t : shell.triangles) {
    const glm::dvec3 a = mesh.vertices[t[0]] - point, b = mesh.vertices[t[1]] - point,
                     c = mesh.vertices[t[2]] - point;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    half_angles +=
        std::atan2(glm::dot(a, glm::cross(b, c)),
                   la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }
  return std::abs(half_angles) > std::numbers::pi;
}

void set_depths(const TriangleMesh& mesh, std::vector<Shell>& shells) {
  std::vector<Box> boxes;
  for (const Shell& shell : shells) boxes.push_back(bounds_of(mesh, shell.triangles));
  for (std::size_t inner = 0; inner < shells.size(); ++inner) {
    const glm::dvec3& point = mesh.vertices[shells[inner].triangles[0][0]];
    for (std::size_t outer = 0; outer < shells.size(); ++outer) {
      if (!lies_within(boxes[inner], boxes[outer])) continue;
      shells[inner].depth += encloses(mesh, shells[outer], point);
    }
  }
}

}  // namespace

TriangleMesh read_mesh(const std::filesystem::path& path) {
  return mesh_from_message(ImportedBytes(ImportFormat::mesh, path).message());
}

TriangleMesh read_mesh_or_points(const std::filesystem::path& path) {
  TriangleMesh mesh = any_mesh(ImportedBytes(ImportFormat::mesh, path).message());
  if (mesh.vertices.empty()) throw std::invalid_argument("has no vertices");
  return mesh;
}

TriangleMesh mesh_from_message(std::string_view message) {
  TriangleMesh mesh = any_mesh(message);
  if (mesh.triangles.empty()) throw std::invalid_argument("has no triangles");
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
  result.triangles = renumbered(mesh.triangles, merged);
  return result;
}

TriangleMesh welded_but_for_rounding(const TriangleMesh& mesh) {
  double largest = std::numeric_limits<float>::min();
  for (const glm::dvec3& v : mesh.vertices) {
    largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  }
  TriangleMesh result;
  NearbyVertices nearby(2 * double(std::numeric_limits<float>::epsilon()) * largest,
                        result.vertices);
  std::vector<std::uint32_t> merged;
  for (const glm::dvec3& vertex : mesh.vertices) merged.push_back(nearby.find_or_add(vertex));
  result.triangles = renumbered(mesh.triangles, merged);
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

std::vector<Shell> shells_of(const TriangleMesh& mesh) {
  Connected sets(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    sets.join(t[0], t[1]);
    sets.join(t[1], t[2]);
  }
  std::vector<Shell> by_root(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    const std::uint32_t root = sets.root(t[0]);
    // The apex is a vertex of the shell: a distant one would cost precision.
    by_root[root].volume += cone6(mesh, t, mesh.vertices[root]) / 6;
    by_root[root].triangles.push_back(t);
  }
  std::erase_if(by_root, [](const Shell& shell) { return shell.triangles.empty(); });
  set_depths(mesh, by_root);
  return by_root;
}

double enclosed_volume(const std::vector<Shell>& shells) {
  double volume = 0;
  for (const Shell& shell : shells) volume += shell.volume;
  return volume;
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
  return bounds_of(mesh, mesh.triangles);
}

}  // namespace wobblebench::phantoms
