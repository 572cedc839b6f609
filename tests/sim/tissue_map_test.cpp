#include "sim/tissue_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <random>

namespace wobblebench::sim {
namespace {

constexpr double kRadius_m = 20e-3;

const phantoms::Phantom& sphere() {
  static const phantoms::Phantom phantom =
      phantoms::make_phantom({.name = "sphere", .radius_m = kRadius_m});
  return phantom;
}

/// The distance that a map knows of the sphere at a place; nothing where the cell does not list it.
std::optional<TissueMap::Distance> distance_at(const TissueMap& map, const glm::dvec3& place) {
  const glm::ivec3 index = map.cell_at(place);
  const auto& cell = map.cell(index);
  if (cell.count == 0) return std::nullopt;
  const glm::vec3 local((place - map.origin_m()) / map.cell_m() - glm::dvec3(index));
  return map.distance(map.entries(cell)[0], local);
}

class TissueMapReach : public testing::TestWithParam<double> {};

TEST_P(TissueMapReach, KnowsDistancesWithinIt) {
  const double reach_m = GetParam();
  const TissueMap map(sphere(), reach_m, 0);
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> coordinate(-30e-3, 30e-3);
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 place(coordinate(generator), coordinate(generator), coordinate(generator));
    const double expected = glm::length(place) - kRadius_m;
    const auto found = distance_at(map, place);
    if (std::abs(expected) > reach_m) continue;
    ASSERT_TRUE(found) << expected;
    // Near the surface the phantom's own voxels, farther out a sweep over steps of two.
    const double tolerance = std::abs(expected) < 1e-3 ? 0.005e-3 : 0.15e-3;
    EXPECT_NEAR(found->value_m, expected, tolerance);
    const glm::dvec3 radial = glm::normalize(place);
    EXPECT_GT(glm::dot(glm::dvec3(found->gradient), radial), 0.9);
  }
}

INSTANTIATE_TEST_SUITE_P(Reaches, TissueMapReach, testing::Values(0.0, 1e-3, 4e-3));

TEST(TissueMap, MaterialIsThatOfTheSideEverywhere) {
  const TissueMap map(sphere(), 4e-3, 0);
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> coordinate(-60e-3, 60e-3);
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 place(coordinate(generator), coordinate(generator), coordinate(generator));
    const double distance = glm::length(place) - kRadius_m;
    if (std::abs(distance) < 0.01e-3) continue;
    EXPECT_EQ(map.material(place),
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
    const glm::dvec3 place(coordinate(generator), coordinate(generator), coordinate(generator));
    const auto a = distance_at(one, place), b = distance_at(four, place);
    ASSERT_EQ(a.has_value(), b.has_value());
    if (a) {
      ASSERT_EQ(a->value_m, b->value_m);
    }
  }
}

}  // namespace
}  // namespace wobblebench::sim
