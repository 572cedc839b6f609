// Meshes: welding, closedness, orientation, volume and area against closed forms.
#include "phantoms/io/triangle_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/phantoms/io/meshes.h"

namespace wobblebench::phantoms {
namespace {

// Each triangle with vertices of its own, as in an STL.
TriangleMesh unwelded(const TriangleMesh& mesh) {
  TriangleMesh soup;
  for (const auto& t : mesh.triangles) {
    const auto first = std::uint32_t(soup.vertices.size());
    for (const std::uint32_t corner : t) soup.vertices.push_back(mesh.vertices[corner]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return soup;
}

double volume(const TriangleMesh& mesh) {
  return enclosed_volume(shells_of(mesh));
}

TEST(TriangleMesh, VolumesAndAreas) {
  EXPECT_NEAR(volume(tetrahedron(3)), 27.0 / 6, 1e-12);
  EXPECT_NEAR(surface_area(tetrahedron(3)), 3 * 4.5 + 4.5 * std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(volume(cube_mesh(2)), 8, 1e-12);
  EXPECT_NEAR(surface_area(cube_mesh(2)), 24, 1e-12);
  EXPECT_NEAR(volume(icosphere(1, 0)), 2.5361507101204, 1e-12) << "regular icosahedron";
  EXPECT_NEAR(volume(icosphere(1, 5)), 4 * std::numbers::pi / 3, 5e-3);
  EXPECT_NEAR(volume(inverted(cube_mesh(2))), -8, 1e-12);
  EXPECT_NEAR(volume(moved(cube_mesh(2), {1e5, 2e5, -1e5})), 8, 1e-9) << "far from the origin";
}

TEST(TriangleMesh, VolumesAreThoseOfEachShell) {
  const auto shells = shells_of(joined(cube_mesh(2), moved(inverted(cube_mesh(1)), {5, 0, 0})));
  ASSERT_EQ(shells.size(), 2u);
  EXPECT_NEAR(shells[0].volume + shells[1].volume, 7, 1e-12);
  EXPECT_NEAR(std::min(shells[0].volume, shells[1].volume), -1, 1e-12);
}

TEST(TriangleMesh, DepthsAreThoseOfNestedShells) {
  TriangleMesh mesh = joined(joined(cube_mesh(8), cube_mesh(4)), inverted(cube_mesh(2)));
  mesh = joined(joined(mesh, moved(cube_mesh(1), {3, 3, 3})), moved(cube_mesh(1), {9, 0, 0}));
  std::vector<std::pair<double, int>> found;
  for (const Shell& shell : shells_of(mesh))
    found.emplace_back(std::round(shell.volume), shell.depth);
  EXPECT_EQ(found,
            (std::vector<std::pair<double, int>>{{512, 0}, {64, 1}, {-8, 2}, {1, 1}, {1, 0}}));
}

TEST(TriangleMesh, WeldsVerticesOfEqualPosition) {
  const TriangleMesh mesh = icosphere(10, 2);
  const TriangleMesh soup = unwelded(mesh);
  EXPECT_EQ(edge_faults(soup).open, 3 * mesh.triangles.size());
  const TriangleMesh whole = welded(soup);
  EXPECT_EQ(whole.vertices.size(), mesh.vertices.size());
  EXPECT_EQ(whole.triangles.size(), mesh.triangles.size());
  const EdgeFaults faults = edge_faults(whole);
  EXPECT_EQ(faults.open + faults.crowded + faults.opposite, 0u);
  EXPECT_NEAR(volume(whole), volume(mesh), 1e-9);
}

TEST(TriangleMesh, DropsTrianglesWithoutArea) {
  TriangleMesh mesh = cube_mesh(1);
  mesh.triangles.push_back({2, 2, 5});
  EXPECT_EQ(welded(mesh).triangles.size(), 12u);
}

TEST(TriangleMesh, MinusZeroIsZero) {
  TriangleMesh mesh = unwelded(tetrahedron(1));
  for (auto& vertex : mesh.vertices) {
    if (vertex.x == 0) vertex.x = -0.0;
    if (vertex.z == 0 && vertex.y == 1) vertex.z = -0.0;
  }
  EXPECT_EQ(welded(mesh).vertices.size(), 4u);
}

TEST(TriangleMesh, CountsFaultyEdges) {
  TriangleMesh open = cube_mesh(1);
  open.triangles.pop_back();
  EXPECT_EQ(edge_faults(open).open, 3u);
  EXPECT_EQ(edge_faults(open).crowded, 0u);

  TriangleMesh fin = cube_mesh(1);
  fin.vertices.push_back({3, 3, 3});
  fin.triangles.push_back({0, 1, 8});  // on the edge 0-1, with two loose edges
  EXPECT_EQ(edge_faults(fin).crowded, 1u);
  EXPECT_EQ(edge_faults(fin).open, 2u);

  TriangleMesh turned = cube_mesh(1);
  std::swap(turned.triangles[4][0], turned.triangles[4][1]);
  EXPECT_EQ(edge_faults(turned).opposite, 3u);
  EXPECT_EQ(edge_faults(turned).open, 0u);
  EXPECT_EQ(edge_faults(inverted(cube_mesh(1))).opposite, 0u)
      << "consistently inside out is no edge fault";
}

TEST(TriangleMesh, BoundsContainEveryTriangle) {
  TriangleMesh mesh = moved(tetrahedron(2), {1, -1, 5});
  mesh.vertices.push_back({99, 99, 99});  // of no triangle
  const Box box = bounds(mesh);
  EXPECT_EQ(box.low, glm::dvec3(1, -1, 5));
  EXPECT_EQ(box.high, glm::dvec3(3, 1, 7));
}

}  // namespace
}  // namespace wobblebench::phantoms
