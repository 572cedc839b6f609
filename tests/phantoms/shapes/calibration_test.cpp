// Steps, cyst and bone plate against closed forms.
#include <gtest/gtest.h>
#include <openvdb/math/Stencils.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "base/units.h"
#include "phantoms/float_grid.h"
#include "phantoms/grids.h"
#include "phantoms/phantom.h"
#include "phantoms/truth.h"
#include "tests/support/expect.h"

namespace wobblebench::phantoms {
namespace {

PhantomOptions named(const std::string& name, double voxel_mm = 0.5) {
  PhantomOptions options;
  options.name = name;
  options.voxel_m = voxel_mm * kMillimetre;
  return options;
}

std::string refusal(const PhantomOptions& options) {
  return refusal_of<InvalidPhantom>([&] { validate(options); });
}

TEST(Steps, LieAtTheirHeights) {
  const Phantom phantom = make_phantom(named("steps"));
  const SurfaceFinder finder(phantom);
  // Six treads 11 mm wide; 1, 2, 3, 5, 8 mm add up.
  const double heights_mm[] = {0, 1, 3, 6, 11, 19};
  for (int tread = 0; tread < 6; ++tread) {
    for (double across = 1; across <= 10; across += 1.5) {
      for (double y : {-30.0, 3.3, 28.0}) {
        const double x = -33 + 11 * tread + across;
        const glm::dvec3 eye{x * kMillimetre, y * kMillimetre, -60 * kMillimetre};
        const auto hit = finder.first_hit(eye, {0, 0, 1}, 0, 0.2);
        ASSERT_TRUE(hit);
        ASSERT_NEAR(hit->distance_m, (60 - heights_mm[tread]) * kMillimetre, 1e-6) << x;
        ASSERT_LT(glm::distance(hit->normal, {0, 0, -1}), 1e-3);
      }
    }
  }
}

TEST(Steps, RisersAreVertical) {
  const Phantom phantom = make_phantom(named("steps"));
  const SurfaceFinder finder(phantom);
  // Along +x, 4 mm above the fifth tread (z = -11 mm): the last riser at x = 22 mm.
  const auto hit = finder.first_hit({0, 0, -15 * kMillimetre}, {1, 0, 0}, 0, 0.1);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance_m, 22 * kMillimetre, 1e-6);
  EXPECT_LT(glm::distance(hit->normal, {-1, 0, 0}), 1e-3);
}

TEST(Steps, TakeOtherHeights) {
  PhantomOptions options = named("steps");
  options.step_heights_m = {0.7 * kMillimetre, 12 * kMillimetre};
  const Phantom phantom = make_phantom(options);
  const SurfaceFinder finder(phantom);
  const double heights_mm[] = {0, 0.7, 12.7};
  for (int tread = 0; tread < 3; ++tread) {
    const auto hit =
        finder.first_hit({(-22 + 22 * tread) * kMillimetre, 0, -0.05}, {0, 0, 1}, 0, 0.2);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->distance_m, (50 - heights_mm[tread]) * kMillimetre, 1e-6);
  }
  EXPECT_LT(phantom.region_of_interest().low.z, -12.7 * kMillimetre);
}

TEST(Steps, RefuseInvalidHeights) {
  PhantomOptions options = named("steps");
  options.step_heights_m = {};
  EXPECT_EQ(refusal(options), "step_heights_mm = 0 numbers: takes 1 to 20 numbers");
  options.step_heights_m.assign(5, 17 * kMillimetre);
  EXPECT_EQ(refusal(options), "step_heights_mm = 85 in all: must be at most 80 in all");
  options.step_heights_m = {-1 * kMillimetre};
  EXPECT_EQ(refusal(options), "step_heights_mm = -1: must be within 0.1 and 20");
  options.step_heights_m.assign(20, 1 * kMillimetre);
  options.voxel_m = 1 * kMillimetre;
  EXPECT_EQ(refusal(options), "voxel_mm = 1: must be at most 0.785714 for the phantom steps");
}

TEST(Cyst, IsABallOfFluidInTissue) {
  PhantomOptions options = named("cyst");
  options.radius_m = 15 * kMillimetre;
  const Phantom phantom = make_phantom(options);
  EXPECT_EQ(phantom.materials()[phantom.background()].name, "soft_tissue");
  ASSERT_EQ(phantom.surfaces().size(), 1u);
  EXPECT_EQ(phantom.materials()[phantom.surfaces()[0].inside].name, "amniotic_fluid");
  const SurfaceFinder finder(phantom);
  for (double x = -12; x <= 12; x += 3) {
    for (double y = -8; y <= 8; y += 4) {
      const double half = std::sqrt(225 - x * x - y * y);
      const double allowed = 0.05 * options.voxel_m * 15 / half;
      const glm::dvec3 eye{x * kMillimetre, y * kMillimetre, -40 * kMillimetre};
      const auto front = finder.first_hit(eye, {0, 0, 1}, 0, 0.1);
      const auto back = finder.first_hit(eye, {0, 0, 1}, 40 * kMillimetre, 0.1);
      ASSERT_TRUE(front && back);
      EXPECT_NEAR(front->distance_m, (40 - half) * kMillimetre, allowed);
      EXPECT_NEAR(back->distance_m, (40 + half) * kMillimetre, allowed);
    }
  }
}

TEST(Cyst, RegionOfInterestStartsInItsFluid) {
  for (double radius_mm : {2.0, 20.0, 60.0}) {
    PhantomOptions options = named("cyst");
    options.radius_m = radius_mm * kMillimetre;
    const Phantom phantom = make_phantom(options);
    const Box& box = phantom.region_of_interest();
    EXPECT_LT(glm::length(box.low), options.radius_m);
    EXPECT_LT(glm::length(glm::dvec3(box.high.x, box.high.y, box.low.z)), options.radius_m);
    // 30 mm of tissue between the face (40 mm) and the cyst.
    EXPECT_NEAR(phantom.suggested_position_m().z - options.radius_m, 70 * kMillimetre, 1e-12);
  }
}

// Trilinear distance of the only surface.
double distance_at(const Phantom& phantom, const glm::dvec3& p) {
  const auto& grid = *phantom.grids().signed_distance[0];
  openvdb::math::BoxStencil<const FloatGrid> stencil(grid);
  const openvdb::Vec3d index = grid.worldToIndex({p.x, p.y, p.z});
  stencil.moveTo(index);
  return stencil.interpolation(index);
}

class BonePlate : public testing::TestWithParam<double> {};

TEST_P(BonePlate, HasItsThicknessAndTilt) {
  PhantomOptions options = named("bone_plate", 0.25);
  options.thickness_m = 4 * kMillimetre;
  options.tilt_x_rad = GetParam();
  const Phantom phantom = make_phantom(options);
  EXPECT_EQ(phantom.materials()[phantom.background()].name, "soft_tissue");
  EXPECT_EQ(phantom.materials()[phantom.surfaces().at(0).inside].name, "cortical_bone");
  EXPECT_FALSE(phantom.surfaces()[0].is_target);
  // -z turned about x.
  const double a = GetParam();
  const glm::dvec3 normal{0, std::sin(a), -std::cos(a)}, along{0, std::cos(a), std::sin(a)};
  for (double x : {-12.0, 0.0, 9.0}) {
    for (double s : {-11.0, 0.0, 12.0}) {
      const glm::dvec3 on_front = kMillimetre * glm::dvec3(x, 0, 0) + s * kMillimetre * along;
      for (double outwards_mm : {0.6, 0.3, 0.0, -0.3, -0.6}) {
        const glm::dvec3 p = on_front + outwards_mm * kMillimetre * normal;
        ASSERT_NEAR(distance_at(phantom, p), outwards_mm * kMillimetre, 1e-6) << outwards_mm;
        const glm::dvec3 q = on_front - (4 + outwards_mm) * kMillimetre * normal;
        ASSERT_NEAR(distance_at(phantom, q), outwards_mm * kMillimetre, 1e-6)
            << "back " << outwards_mm;
      }
    }
  }
  // Half of its width is 15 mm.
  const glm::dvec3 edge = kMillimetre * glm::dvec3(15, 0, 0) - 2 * kMillimetre * normal;
  EXPECT_NEAR(distance_at(phantom, edge), 0, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Tilts, BonePlate, testing::Values(0.0, 0.35, -0.6));

TEST(BonePlateOptions, RefuseVoxelsThatDoNotResolveIt) {
  PhantomOptions options = named("bone_plate", 2);
  EXPECT_EQ(refusal(options), "voxel_mm = 2: must be at most 1.5 for the phantom bone_plate");
}

}  // namespace
}  // namespace wobblebench::phantoms
