#include "sim/tissue_sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "hw/acquisition_plan.h"

namespace wobblebench::sim {
namespace {

constexpr double kRadius_m = 20e-3;
constexpr double kSpacing_m = 0.15e-3;
constexpr int kCount = 1066;

const phantoms::Phantom& sphere() {
  static const phantoms::Phantom phantom =
      phantoms::make_phantom({.name = "sphere", .radius_m = kRadius_m});
  return phantom;
}

/// Ranges at which a ray enters and leaves the sphere, and the cosine of incidence; empty: a miss.
std::vector<double> sphere_crossings(const hw::Ray& ray, const glm::dvec3& center) {
  const glm::dvec3 to_center = center - ray.origin;
  const double along = glm::dot(to_center, ray.direction);
  const double off2 = glm::dot(to_center, to_center) - along * along;
  if (off2 >= kRadius_m * kRadius_m) return {};
  const double half = std::sqrt(kRadius_m * kRadius_m - off2);
  return {along - half, along + half, half / kRadius_m};
}

TEST(TissueSampler, FindsBothSidesOfASphereFromEveryStick) {
  const phantoms::Placement placement{phantoms::rotation_xyz({0.3, -0.2, 0.1}),
                                      {5e-3, -3e-3, 0.11}};
  TissueSampler sampler(sphere(), placement);
  const hw::AcquisitionPlan plan({}, {});
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> angle(-0.35, 0.35);
  int hits = 0;
  for (int i = 0; i < 500; ++i) {
    const hw::Ray stick = plan.geometry().stick(angle(generator), angle(generator));
    const auto expected = sphere_crossings(stick, placement.position_m);
    const auto profile = sampler.profile(stick, kSpacing_m, kCount);
    if (expected.empty() || expected[1] - expected[0] < 2e-3) continue;
    ++hits;
    ASSERT_EQ(profile.interfaces.size(), 2u);
    for (std::size_t side = 0; side < 2; ++side) {
      // Trilinear interpolation of a curved distance errs by up to voxel^2 / (8 radius) along the
      // normal, more along a grazing ray.
      EXPECT_NEAR(profile.interfaces[side].range_m, expected[side], 0.01e-3 / expected[2]);
      EXPECT_NEAR(profile.interfaces[side].cos_incidence, expected[2], 0.01);
    }
    EXPECT_EQ(profile.interfaces[0].behind, sphere().surfaces()[0].inside);
    EXPECT_EQ(profile.interfaces[1].behind, sphere().background());
  }
  EXPECT_GT(hits, 100);
}

TEST(TissueSampler, StretchesCoverTheStickAndChangeAtItsInterfaces) {
  TissueSampler sampler(sphere(), {glm::dmat3(1.0), {0, 0, 0.11}});
  const auto profile = sampler.profile({{0, 0, 0.04}, {0, 0, 1}}, kSpacing_m, kCount);
  ASSERT_EQ(profile.stretches.size(), 3u);
  EXPECT_EQ(profile.stretches.front().first, 0);
  EXPECT_EQ(profile.stretches.back().last, kCount);
  for (std::size_t i = 1; i < profile.stretches.size(); ++i) {
    EXPECT_EQ(profile.stretches[i].first, profile.stretches[i - 1].last);
    const double at = profile.interfaces[i - 1].range_m;
    EXPECT_GT(at, (profile.stretches[i].first - 0.5) * kSpacing_m);
    EXPECT_LE(at, (profile.stretches[i].first + 0.5) * kSpacing_m);
  }
}

TEST(TissueSampler, AStickThatMissesSeesFluidAlone) {
  TissueSampler sampler(sphere(), {glm::dmat3(1.0), {0, 0, 0.11}});
  const auto profile = sampler.profile({{0.05, 0, 0.04}, {0, 0, 1}}, kSpacing_m, kCount);
  EXPECT_TRUE(profile.interfaces.empty());
  ASSERT_EQ(profile.stretches.size(), 1u);
  EXPECT_EQ(profile.stretches[0].material, sphere().background());
}

}  // namespace
}  // namespace wobblebench::sim
