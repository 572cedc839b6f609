// Where a turned body lies before the probe, against bounds of its own corners and balls.
#include "phantoms/framing.h"

#include <gtest/gtest.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <vector>

#include "base/units.h"
#include "phantoms/truth.h"
#include "tests/phantoms/io/meshes.h"
#include "tests/support/folder_test.h"

namespace wobblebench::phantoms {
namespace {

using Angles = glm::dvec3;

const std::vector<Angles> kTurns = {
    {180, 0, 0}, {0, 180, 0}, {0, 90, 0}, {-90, 0, 0}, {30, -50, 70}, {0, 0, 45}};

/// Two thirds of it lie behind its widest part, and it leans to one side.
TriangleMesh egg() {
  TriangleMesh mesh = icosphere(20, 5);
  for (glm::dvec3& v : mesh.vertices) {
    if (v.z > 0) v.z *= 2.5;
    v.x = 1.4 * v.x + 0.01 * v.z * v.z;
  }
  return mesh;
}

Box bounds_of(const std::vector<glm::dvec3>& points) {
  Box box{points.front(), points.front()};
  for (const glm::dvec3& p : points) box = {glm::min(box.low, p), glm::max(box.high, p)};
  return box;
}

class TurnedMesh : public testing_support::FolderTest {
 protected:
  Phantom import(const TriangleMesh& mesh) {
    write_obj(mesh, file("body.obj"));
    return make_phantom({.name = "mesh", .file = file("body.obj").string()});
  }
  /// The vertices as the import places them, turned.
  static std::vector<glm::dvec3> turned(const TriangleMesh& mesh, const glm::dmat3& rotation) {
    const Box box = bounds_of(mesh.vertices);
    std::vector<glm::dvec3> points;
    for (const glm::dvec3& v : mesh.vertices) {
      points.push_back(rotation * (v - 0.5 * (box.low + box.high)) * kMillimetre);
    }
    return points;
  }
};

TEST_F(TurnedMesh, LiesWithItsFrontBelowTheProbeAndInTheBox) {
  const TriangleMesh mesh = egg();
  const Phantom phantom = import(mesh);
  for (const Angles& degrees : kTurns) {
    SCOPED_TRACE(testing::PrintToString(std::vector{degrees.x, degrees.y, degrees.z}));
    const glm::dmat3 rotation = rotation_xyz(degrees * kDegree);
    const Framing framing = phantoms::framing(phantom, rotation);
    const Box body = bounds_of(turned(mesh, rotation));
    constexpr double kVoxel = 0.5 * kMillimetre;
    EXPECT_NEAR(framing.position_m.z + body.low.z, 105 * kMillimetre, kVoxel);
    EXPECT_NEAR(framing.position_m.x, -0.5 * (body.low.x + body.high.x), kVoxel);
    EXPECT_NEAR(framing.position_m.y, -0.5 * (body.low.y + body.high.y), kVoxel);
    const Box& box = framing.region_of_interest;
    EXPECT_NEAR(box.low.z, body.low.z - 10 * kMillimetre, kVoxel) << "it starts in the fluid";
    for (int axis = 0; axis < 2; ++axis) {
      EXPECT_LT(box.low[axis], body.low[axis]);
      EXPECT_GT(box.high[axis], body.high[axis]);
      EXPECT_NEAR(box.high[axis], body.high[axis] + 5 * kMillimetre, kVoxel);
    }
  }
}

/// Rays from the front of the box meet the body from outside.
TEST_F(TurnedMesh, IsSeenFromOutside) {
  const Phantom phantom = import(egg());
  const SurfaceFinder finder(phantom);
  for (const Angles& degrees : kTurns) {
    const glm::dmat3 rotation = rotation_xyz(degrees * kDegree);
    const Framing framing = phantoms::framing(phantom, rotation);
    const Placement placement{rotation, framing.position_m};
    const Box& box = framing.region_of_interest;
    int met = 0;
    for (int i = 0; i < 400; ++i) {
      const double u = (i % 20 + 0.5) / 20, v = (i / 20 + 0.5) / 20;
      const glm::dvec3 start(
          glm::mix(box.low.x, box.high.x, u), glm::mix(box.low.y, box.high.y, v), box.low.z);
      const auto direction = placement.direction_to_phantom({0, 0, 1});
      const auto hit = finder.first_hit(
          placement.to_phantom(start + framing.position_m), direction, 0, 60 * kMillimetre);
      if (!hit) continue;
      ++met;
      EXPECT_LE(glm::dot(hit->normal, direction), 0.05) << "from inside";
    }
    EXPECT_GT(met, 100);
  }
}

TEST_F(TurnedMesh, NotTurnedItLiesAsImported) {
  const Phantom phantom = import(egg());
  const Framing framing = phantoms::framing(phantom, glm::dmat3(1.0));
  EXPECT_EQ(framing.position_m, phantom.suggested_position_m());
  EXPECT_EQ(framing.region_of_interest.low, phantom.region_of_interest().low);
  EXPECT_EQ(framing.region_of_interest.high, phantom.region_of_interest().high);
}

TEST_F(TurnedMesh, ReadBackItIsStillTurnedAsABody) {
  const Phantom phantom = import(egg());
  write_phantom(phantom, file("egg.vdb"));
  const glm::dmat3 rotation = rotation_xyz({kPi, 0, 0});
  const Phantom read = read_phantom(file("egg.vdb"));
  EXPECT_EQ(framing(read, rotation).position_m, framing(phantom, rotation).position_m);
}

TEST(TurnedPhantom, OfOursTurnsWithItsRegion) {
  const Phantom ball = make_phantom({.name = "sphere", .voxel_m = 2e-3});
  const Framing framing = phantoms::framing(ball, rotation_xyz({0, kPi / 2, 0}));
  // About y, z turns to x and x to -z.
  const Box& box = ball.region_of_interest();
  EXPECT_NEAR(framing.region_of_interest.low.x, box.low.z, 1e-15);
  EXPECT_NEAR(framing.region_of_interest.high.z, -box.low.x, 1e-15);
  EXPECT_EQ(framing.position_m, ball.suggested_position_m());
}

}  // namespace
}  // namespace wobblebench::phantoms
