// A drawn surface against the closed form of a ball.
#include "phantoms/surface_mesh.h"

#include <gtest/gtest.h>

#include <array>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>

namespace wobblebench::phantoms {
namespace {

double enclosed_m3(const SurfaceMesh& mesh) {
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    volume += glm::dot(mesh.points_m[a], glm::cross(mesh.points_m[b], mesh.points_m[c])) / 6;
  }
  return volume;
}

TEST(SurfaceMesh, OfABallIsClosedAndLiesOnIt) {
  const double radius_m = 30e-3;
  const Phantom ball = make_phantom({.name = "sphere", .voxel_m = 1e-3, .radius_m = radius_m});
  for (const double edges : {16.0, 48.0}) {
    const SurfaceMesh mesh = surface_mesh(ball, 0, edges);
    const double cube_m = 2 * radius_m / edges;
    for (const glm::dvec3& point : mesh.points_m) {
      EXPECT_NEAR(glm::length(point), radius_m, 0.5 * cube_m);
    }
    std::map<std::array<std::uint32_t, 2>, int> edges_seen;
    for (const auto& corners : mesh.triangles) {
      for (int i = 0; i < 3; ++i) ++edges_seen[{corners[i], corners[(i + 1) % 3]}];
    }
    for (const auto& [edge, count] : edges_seen) {
      EXPECT_EQ(count, 1);
      EXPECT_EQ(edges_seen.count({edge[1], edge[0]}), 1U);
    }
    const double ball_m3 = 4.0 / 3 * std::numbers::pi * radius_m * radius_m * radius_m;
    EXPECT_NEAR(std::abs(enclosed_m3(mesh)), ball_m3, 0.05 * ball_m3);
    EXPECT_LT(mesh.triangles.size(), 13 * edges * edges);
  }
}

}  // namespace
}  // namespace wobblebench::phantoms
