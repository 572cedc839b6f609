#include "sim/tissue/tissue_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "phantoms/grids.h"
#include "phantoms/phantom.h"
#include "sim/tissue/stick_track.h"
#include "tests/support/expect.h"

namespace wobblebench::sim {
namespace {

constexpr double kBallRadius_m = 20e-3;

const phantoms::Phantom& sphere() {
  static const phantoms::Phantom phantom =
      phantoms::make_phantom({.name = "sphere", .radius_m = kBallRadius_m});
  return phantom;
}

/// A map's distance to the sphere; nothing where the cell has no entry for it.
std::optional<TissueMap::Distance> distance_at(const TissueMap& map, const glm::dvec3& position) {
  const glm::ivec3 index = map.cell_at(position);
  const auto& cell = map.cell(index);
  if (cell.count == 0) return std::nullopt;
  const glm::vec3 local((position - map.origin_m()) / map.cell_m() - glm::dvec3(index));
  return map.distance(map.entries(cell)[0], local);
}

class TissueMapReach : public testing::TestWithParam<double> {};

TEST_P(TissueMapReach, HoldsDistancesWithinIt) {
  const double reach_m = GetParam();
  const TissueMap map(sphere(), reach_m, 0);
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> coordinate(-30e-3, 30e-3);
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 position(coordinate(generator), coordinate(generator), coordinate(generator));
    const double expected = glm::length(position) - kBallRadius_m;
    const auto found = distance_at(map, position);
    if (std::abs(expected) > reach_m) continue;
    ASSERT_TRUE(found) << expected;
    // Near the surface the phantom's own voxels, farther out fast sweeping over two steps.
    const double tolerance = std::abs(expected) < 1e-3 ? 0.005e-3 : 0.15e-3;
    EXPECT_NEAR(found->value_m, expected, tolerance);
    const glm::dvec3 radial = glm::normalize(position);
    EXPECT_GT(glm::dot(glm::dvec3(found->gradient), radial), 0.9);
  }
}

INSTANTIATE_TEST_SUITE_P(Reaches, TissueMapReach, testing::Values(0.0, 1e-3, 4e-3));

/// A band of 0.4 mm, and nodes 0.5 mm apart.
TEST(TissueMap, OfVoxelsFinerThanItsStepsHoldsDistances) {
  constexpr double kReach_m = 2e-3, kSmall_m = 6e-3;
  const auto phantom =
      phantoms::make_phantom({.name = "sphere", .voxel_m = 0.1e-3, .radius_m = kSmall_m});
  const TissueMap map(phantom, kReach_m, 0);
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> coordinate(-10e-3, 10e-3);
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 position(coordinate(generator), coordinate(generator), coordinate(generator));
    const double expected = glm::length(position) - kSmall_m;
    if (std::abs(expected) > kReach_m) continue;
    const auto found = distance_at(map, position);
    ASSERT_TRUE(found) << expected;
    ASSERT_NEAR(found->value_m, expected, 0.15e-3);
  }
}

/// Nodes on a plane are neither inside nor outside.
TEST(TissueMap, OfAPlaneThroughItsNodesHoldsDistances) {
  const auto plate =
      phantoms::make_phantom({.name = "bone_plate", .voxel_m = 0.1e-3, .thickness_m = 1e-3});
  const TissueMap map(plate, 2e-3, 0);
  for (double z = -1.9e-3; z < 2.9e-3; z += 0.07e-3) {
    const auto found = distance_at(map, {1e-3, 2e-3, z});
    ASSERT_TRUE(found) << z;
    EXPECT_NEAR(found->value_m, std::abs(z - 0.5e-3) - 0.5e-3, 0.05e-3) << z;
  }
}

TEST(TissueMap, MaterialIsThatOfTheSurfacesSide) {
  const TissueMap map(sphere(), 4e-3, 0);
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> coordinate(-60e-3, 60e-3);
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 position(coordinate(generator), coordinate(generator), coordinate(generator));
    const double distance = glm::length(position) - kBallRadius_m;
    if (std::abs(distance) < 0.01e-3) continue;
    EXPECT_EQ(map.material(position),
              distance < 0 ? sphere().surfaces()[0].inside : sphere().background());
  }
}

TEST(TissueMap, LaterSurfacesWin) {
  const auto face = phantoms::make_phantom({.voxel_m = 1e-3});
  const TissueMap map(face, 2e-3, 0);
  const auto material = [&](const char* name) {
    for (std::size_t i = 0; i < face.materials().size(); ++i) {
      if (face.materials()[i].name == name) return static_cast<int>(i);
    }
    return -1;
  };
  // The middle of the head: brain, painted over skull, skin and cavity.
  EXPECT_EQ(map.material({0, -5e-3, 40e-3}), material("brain"));
  EXPECT_EQ(map.material({0, 0, -30e-3}), material("amniotic_fluid"));
}

TEST(TissueMap, IsTheSameAtAnyNumberOfThreads) {
  const auto face = phantoms::make_phantom({.voxel_m = 1e-3});
  const TissueMap one(face, 3e-3, 1), four(face, 3e-3, 4);
  ASSERT_EQ(one.bytes(), four.bytes());
  ASSERT_EQ(one.cells(), four.cells());
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> coordinate(-70e-3, 90e-3);
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 position(coordinate(generator), coordinate(generator), coordinate(generator));
    const auto a = distance_at(one, position), b = distance_at(four, position);
    ASSERT_EQ(a.has_value(), b.has_value());
    if (a) {
      ASSERT_EQ(a->value_m, b->value_m);
    }
  }
}

TEST(TissueMap, ALineHasTheDistancesAtItsPositions) {
  const TissueMap map(sphere(), 4e-3, 0);
  std::mt19937 generator(11);
  std::uniform_real_distribution<float> within(0, 1), slope(-1, 1);
  std::uniform_real_distribution<double> coordinate(-25e-3, 25e-3);
  constexpr double kRounding_m = 4e-9;  // of a float of 8 mm
  constexpr int kPositions = 11;        // more than the loop's SIMD lanes, and no multiple of them
  int lines = 0;
  for (int i = 0; i < 5000; ++i) {
    const glm::dvec3 position(coordinate(generator), coordinate(generator), coordinate(generator));
    const auto& cell = map.cell(map.cell_at(position));
    if (cell.count == 0) continue;
    const TissueMap::Entry& entry = map.entries(cell)[0];
    const auto any = [&](auto& share) {
      return glm::vec3(share(generator), share(generator), share(generator));
    };
    const glm::vec3 begin = any(within), end = any(within);
    const TissueMap::Line line{
        begin, (end - begin) / (kPositions - 1.0f), any(slope), any(slope), any(slope)};
    TrackNode nodes[kPositions];
    map.trace(entry, line, kPositions, nodes);
    for (int n = 0; n < kPositions; ++n) {
      const auto at = map.distance(entry, begin + static_cast<float>(n) * line.stride);
      EXPECT_NEAR(nodes[n].value_m, at.value_m, kRounding_m);
      EXPECT_NEAR(
          map.value_m(entry, begin + static_cast<float>(n) * line.stride), at.value_m, kRounding_m);
      // On the boundary between two intervals the slope of either is right.
      const float error = nodes[n].axial - glm::dot(at.gradient, line.axial);
      EXPECT_LT(std::abs(error), 0.15f);
    }
    ++lines;
  }
  EXPECT_GT(lines, 500);
}

TEST(TissueMap, NormalsPointOutwards) {
  const TissueMap map(sphere(), 1e-3, 0);
  std::mt19937 generator(13);
  std::normal_distribution<double> any;
  std::uniform_real_distribution<double> off(-0.2e-3, 0.2e-3);
  for (int i = 0; i < 5000; ++i) {
    const glm::dvec3 radial =
        glm::normalize(glm::dvec3(any(generator), any(generator), any(generator)));
    const glm::dvec3 normal = map.normal(0, (kBallRadius_m + off(generator)) * radial);
    // The angle between them, to first order.
    EXPECT_LT(glm::length(normal - radial), 0.0005);
  }
  EXPECT_EQ(map.normal(0, glm::dvec3(0)), glm::dvec3(0));
}

TEST(TissueMap, RefusesMoreSurfacesThanItCanNumber) {
  const phantoms::Phantom& one = sphere();
  const auto many = [&](std::size_t surfaces) {
    auto grids = std::make_shared<phantoms::Grids>();
    grids->signed_distance.assign(surfaces, one.grids().signed_distance[0]);
    return phantoms::Phantom("many",
                             one.materials(),
                             one.background(),
                             std::vector(surfaces, one.surfaces()[0]),
                             one.region_of_interest(),
                             one.suggested_position_m(),
                             std::move(grids));
  };
  EXPECT_NO_THROW(TissueMap(many(3), 1e-3, 0));
  EXPECT_TRUE(holds(refusal_of<std::runtime_error>(
                        [&] { const TissueMap map(many(TissueMap::kMaxSurfaces + 1), 1e-3, 0); }),
                    "at most 255"));
}

}  // namespace
}  // namespace wobblebench::sim
