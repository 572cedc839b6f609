// Ray hits and distances against closed forms.
#include "phantoms/truth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <random>

namespace wobblebench::phantoms {
namespace {

constexpr double kVoxel = 0.5e-3;
constexpr double kAllowedVoxels = 0.05;

glm::dvec3 random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
}

Phantom ball(double radius_m) {
  PhantomOptions options;
  options.name = "sphere";
  options.radius_m = radius_m;
  options.voxel_m = kVoxel;
  return make_phantom(options);
}

TEST(SurfaceFinder, HitsTheSphereFromOutside) {
  constexpr double kRadius = 20e-3;
  const Phantom phantom = ball(kRadius);
  const SurfaceFinder finder(phantom);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> offset(0, 0.9 * kRadius), far(60e-3, 400e-3);
  for (int i = 0; i < 5000; ++i) {
    const glm::dvec3 direction = random_direction(random);
    const glm::dvec3 side = glm::normalize(glm::cross(direction, random_direction(random)));
    const double miss = offset(random), start = far(random);
    const auto hit = finder.first_hit(miss * side - start * direction, direction, 0, 1);
    ASSERT_TRUE(hit) << "ray " << i;
    const double truth = start - std::sqrt(kRadius * kRadius - miss * miss);
    // Along a slanting ray a distance error grows with 1 / cos(incidence).
    const double cosine = std::sqrt(1 - miss * miss / (kRadius * kRadius));
    ASSERT_NEAR(hit->distance_m, truth, kAllowedVoxels * kVoxel / cosine) << "ray " << i;
    const glm::dvec3 normal = (miss * side + (truth - start) * direction) / kRadius;
    ASSERT_GT(glm::dot(hit->normal, normal), std::cos(0.02)) << "ray " << i;
    ASSERT_EQ(hit->surface, 0);
  }
}

TEST(SurfaceFinder, HitsTheSphereFromInside) {
  constexpr double kRadius = 20e-3;
  const Phantom phantom = ball(kRadius);
  const SurfaceFinder finder(phantom);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> within(0, 0.97 * kRadius);
  for (int i = 0; i < 5000; ++i) {
    const glm::dvec3 start = within(random) * random_direction(random);
    const glm::dvec3 direction = random_direction(random);
    const auto hit = finder.first_hit(start, direction, 0, 1);
    ASSERT_TRUE(hit) << "ray " << i;
    const double b = glm::dot(start, direction);
    const double root = std::sqrt(b * b - glm::dot(start, start) + kRadius * kRadius);
    ASSERT_NEAR(hit->distance_m, root - b, kAllowedVoxels * kVoxel * kRadius / root) << i;
    ASSERT_GT(glm::dot(hit->normal, direction), 0) << "normals point out of the tissue";
  }
}

TEST(SurfaceFinder, MissesTheSphere) {
  const Phantom phantom = ball(20e-3);
  const SurfaceFinder finder(phantom);
  std::mt19937 random(3);
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 direction = random_direction(random);
    const glm::dvec3 side = glm::normalize(glm::cross(direction, random_direction(random)));
    ASSERT_FALSE(finder.first_hit(20.1e-3 * side - 0.2 * direction, direction, 0, 1));
  }
}

TEST(SurfaceFinder, FindsHitsWithinTheRangeOnly) {
  const Phantom phantom = ball(20e-3);
  const SurfaceFinder finder(phantom);
  const glm::dvec3 eye{1e-3, 2e-3, -100e-3}, ahead{0, 0, 1};
  const double half = std::sqrt(20e-3 * 20e-3 - 5e-6);
  EXPECT_FALSE(finder.first_hit(eye, ahead, 0, 0.1 - half - 1e-4));
  EXPECT_TRUE(finder.first_hit(eye, ahead, 0, 0.1 - half + 1e-4));
  const auto back = finder.first_hit(eye, ahead, 0.1, 0.3);
  ASSERT_TRUE(back);
  EXPECT_NEAR(back->distance_m, 0.1 + half, kAllowedVoxels * kVoxel);
  EXPECT_FALSE(finder.first_hit(eye, ahead, 0.2, 0.3));
  EXPECT_FALSE(finder.first_hit(eye, ahead, 0.3, 0.2));
}

class TiltedPlane : public testing::TestWithParam<glm::dvec2> {};

TEST_P(TiltedPlane, IsWhereItsNormalSays) {
  PhantomOptions options;
  options.name = "plane";
  options.tilt_x_rad = GetParam().x;
  options.tilt_y_rad = GetParam().y;
  options.voxel_m = kVoxel;
  const Phantom phantom = make_phantom(options);
  const SurfaceFinder finder(phantom);
  // -z rotated about x, then about y, independently of rotation_xyz().
  const double a = options.tilt_x_rad, b = options.tilt_y_rad;
  const glm::dvec3 normal{-std::sin(b) * std::cos(a), std::sin(a), -std::cos(b) * std::cos(a)};
  std::mt19937 random(4);
  std::uniform_real_distribution<double> across(-35e-3, 35e-3), slant(-0.3, 0.3);
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 eye{across(random), across(random), -150e-3};
    const glm::dvec3 direction = glm::normalize(glm::dvec3(slant(random), slant(random), 1));
    const double cosine = -glm::dot(direction, normal);
    const double truth = glm::dot(eye, normal) / cosine;
    const glm::dvec3 position = eye + truth * direction;
    if (cosine < 0.2 || truth < 0 || glm::length(position) > 100e-3) continue;
    const auto hit = finder.first_hit(eye, direction, 0, 1);
    ASSERT_TRUE(hit) << "ray " << i;
    ASSERT_NEAR(hit->distance_m, truth, 1e-3 * kVoxel / cosine) << "a trilinear plane is exact";
    ASSERT_NEAR(glm::length(hit->normal - normal), 0, 1e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(Tilts,
                         TiltedPlane,
                         testing::Values(glm::dvec2(0, 0),
                                         glm::dvec2(0.3, 0),
                                         glm::dvec2(0, -0.5),
                                         glm::dvec2(0.4, 0.7),
                                         glm::dvec2(-1.0, 0.2)));

TEST(SurfaceFinder, HitsThePlaneAlongTheAxes) {
  // Rays along a grid line, through voxel centres and on the faces of leaves.
  PhantomOptions options;
  options.name = "plane";
  options.voxel_m = kVoxel;
  const Phantom phantom = make_phantom(options);
  const SurfaceFinder finder(phantom);
  for (int x = -70; x <= 70; x += 2) {
    const auto hit = finder.first_hit({x * kVoxel, 8 * kVoxel, -0.1}, {0, 0, 1}, 0, 1);
    ASSERT_TRUE(hit) << x;
    ASSERT_NEAR(hit->distance_m, 0.1, 1e-3 * kVoxel);
  }
}

TEST(SurfaceFinder, FindsACrossingJustBeforeTheLimit) {
  const Phantom phantom = ball(20e-3);
  const SurfaceFinder finder(phantom);
  std::mt19937 random(6);
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 direction = random_direction(random);
    const auto hit = finder.first_hit(-0.1 * direction, direction, 0, 0.08 + 0.06 * kVoxel);
    ASSERT_TRUE(hit) << "ray " << i;
    ASSERT_FALSE(finder.first_hit(-0.1 * direction, direction, 0, 0.08 - 0.06 * kVoxel));
    // From within the band, on either side of the surface, close by.
    ASSERT_TRUE(finder.first_hit(-0.0201 * direction, direction, 0, 0.2e-3));
    ASSERT_TRUE(finder.first_hit(0.0199 * direction, direction, 0, 0.2e-3));
  }
}

TEST(SurfaceFinder, DistanceIsSignedAndEndsWithTheBand) {
  const Phantom phantom = ball(20e-3);
  const SurfaceFinder finder(phantom);
  const auto outside = finder.distance({0, 0, -20.7e-3}), inside = finder.distance({19.3e-3, 0, 0});
  ASSERT_TRUE(outside && inside);
  EXPECT_NEAR(outside->value_m, 0.7e-3, 0.05 * kVoxel);
  EXPECT_NEAR(glm::length(outside->gradient - glm::dvec3(0, 0, -1)), 0, 0.05);
  EXPECT_NEAR(inside->value_m, -0.7e-3, 0.05 * kVoxel);
  EXPECT_FALSE(finder.distance({0, 0, 0}));
  EXPECT_FALSE(finder.distance({0, 0, 1}));
}

TEST(SurfaceFinder, ABoxLimitsWhereBandsAreWidened) {
  constexpr double kReach = 6e-3;
  const Phantom phantom = ball(20e-3);
  const Box box{{-4e-3, -10e-3, -30e-3}, {25e-3, 12e-3, 5e-3}};
  const SurfaceFinder whole(phantom, kReach), part(phantom, kReach, box);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0, 1);
  int known = 0;
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 at =
        box.low + (box.high - box.low) * glm::dvec3(share(random), share(random), share(random));
    const double truth = glm::length(at) - 20e-3;
    if (std::abs(truth) > kReach - kVoxel) continue;
    const auto a = whole.distance(at), b = part.distance(at);
    ASSERT_TRUE(a && b) << i;
    ASSERT_NEAR(b->value_m, truth, kVoxel) << "widened bands are first order";
    ASSERT_NEAR(b->value_m, a->value_m, 0.02 * kVoxel);
    ++known;
  }
  EXPECT_GT(known, 2000);
  EXPECT_TRUE(whole.distance({-25e-3, 0, 0}));
  EXPECT_FALSE(part.distance({-25e-3, 0, 0})) << "outside the box";
}

TEST(SurfaceFinder, ABoxFarFromAllSurfacesHasNoDistances) {
  const SurfaceFinder finder(ball(20e-3), 6e-3, Box{glm::dvec3(80e-3), glm::dvec3(100e-3)});
  EXPECT_FALSE(finder.distance({90e-3, 90e-3, 90e-3}));
}

/// Boxes from which the surface is out of reach, but not its narrow band.
TEST(SurfaceFinder, ABoxBesideTheSurfaceIsNoError) {
  constexpr double kReach = 8e-3, kHalf = 3e-3;
  const Phantom phantom = ball(20e-3);
  for (double z = -40e-3; z < 0; z += 0.5e-3) {
    const Box box{{-kHalf, -kHalf, z - kHalf}, {kHalf, kHalf, z + kHalf}};
    const SurfaceFinder finder(phantom, kReach, box);
    const double truth = -z - 20e-3;
    if (std::abs(truth) > kReach - kVoxel) continue;
    const auto found = finder.distance({0, 0, z});
    ASSERT_TRUE(found) << z;
    EXPECT_NEAR(found->value_m, truth, kVoxel);
  }
}

TEST(SurfaceFinder, DistanceBoundIsALowerBound) {
  const Phantom phantom = ball(20e-3);
  const SurfaceFinder finder(phantom);
  ASSERT_EQ(finder.targets(), 1);
  EXPECT_EQ(finder.surface(0), 0);
  std::mt19937 random(8);
  std::uniform_real_distribution<double> coordinate(-80e-3, 80e-3);
  for (int i = 0; i < 50000; ++i) {
    const glm::dvec3 at{coordinate(random), coordinate(random), coordinate(random)};
    const double truth = glm::length(at) - 20e-3;
    const double bound = finder.distance_bound(0, at);
    if (const auto exact = finder.target_distance(0, at)) {
      ASSERT_EQ(bound, exact->value_m);
      // At the rim of the band, interpolation uses the constant background: too small.
      if (std::abs(truth) < 3 * kVoxel) {
        ASSERT_NEAR(bound, truth, 0.1 * kVoxel);
      } else {
        ASSERT_LE(std::abs(bound), std::abs(truth) + 0.1 * kVoxel);
      }
      continue;
    }
    ASSERT_EQ(bound < 0, truth < 0);
    ASSERT_LE(std::abs(bound), std::abs(truth));
    // Not so much less that sphere tracing would take many steps.
    ASSERT_GE(std::abs(bound), std::abs(truth) / 3 - 16 * kVoxel);
    ASSERT_GT(std::abs(bound), 2 * kVoxel);
  }
}

TEST(SurfaceFinder, DistanceIsThatToTheNearestOfItsTargets) {
  PhantomOptions options;
  options.voxel_m = 2e-3;
  options.maternal_layer_m = 0;
  const Phantom phantom = make_phantom(options);
  const SurfaceFinder finder(phantom);
  int targets = 0;
  for (const Surface& surface : phantom.surfaces()) targets += surface.is_target;
  ASSERT_EQ(finder.targets(), targets);
  std::mt19937 random(9);
  std::uniform_real_distribution<double> coordinate(-60e-3, 60e-3);
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 at{coordinate(random), coordinate(random), coordinate(random)};
    double nearest = std::numeric_limits<double>::infinity();
    for (int target = 0; target < targets; ++target) {
      const auto known = finder.target_distance(target, at);
      if (known) nearest = std::min(nearest, std::abs(known->value_m));
    }
    const auto known = finder.distance(at);
    ASSERT_EQ(known.has_value(), std::isfinite(nearest));
    if (known) {
      ASSERT_EQ(std::abs(known->value_m), nearest);
    }
  }
}

TEST(SurfaceFinder, FindsNoTargetInTheSpeckleBlockNorAmongPoints) {
  for (const char* name : {"speckle_block", "points"}) {
    const SurfaceFinder finder(make_phantom({.name = name, .voxel_m = 2e-3}));
    EXPECT_EQ(finder.targets(), 0);
    EXPECT_FALSE(finder.first_hit({0, 0, -1}, {0, 0, 1}, 0, 2));
    EXPECT_FALSE(finder.distance({0, 0, 0}));
  }
}

TEST(SurfaceFinder, CopiesAgree) {
  const Phantom phantom = ball(10e-3);
  const SurfaceFinder first(phantom);
  const SurfaceFinder second(first);
  const auto a = first.first_hit({1e-3, 0, -0.1}, {0, 0, 1}, 0, 1);
  const auto b = second.first_hit({1e-3, 0, -0.1}, {0, 0, 1}, 0, 1);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->distance_m, b->distance_m);
}

}  // namespace
}  // namespace wobblebench::phantoms
