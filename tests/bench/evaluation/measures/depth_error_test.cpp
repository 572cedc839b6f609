// Error measures of depth images with known errors.
#include "bench/evaluation/measures/depth_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "render/camera.h"
#include "tests/bench/evaluation/measures/made_up_truth.h"

namespace wobblebench::bench {
namespace {

constexpr int kSize = 20;

render::Camera small_camera() {
  render::RenderOptions options;
  options.ray_casting.image_size = kSize;
  return render::make_camera(options);
}

Truth small_flat_truth() {
  return flat_truth(kSize);
}

TEST(DepthStatistics, OutliersAreTheShareBeyondTenMillimetres) {
  EXPECT_EQ(depth_statistics({0.0, 0.0099, 0.0101, -0.02}).outlier_share, 0.5);
  EXPECT_EQ(depth_statistics({0.001}).outlier_share, 0);
  EXPECT_TRUE(std::isnan(depth_statistics({}).outlier_share));
}

TEST(DepthError, OfThePerfectPictureIsZero) {
  const Truth truth = small_flat_truth();
  const DepthError error = measure_depth_error(truth.depth_m, truth, small_camera());
  EXPECT_EQ(error.depth.n, kSize * kSize);
  EXPECT_EQ(error.depth.rms_m, 0);
  EXPECT_EQ(error.depth.max_m, 0);
  EXPECT_EQ(error.missed, 0);
  EXPECT_EQ(error.false_surface, 0);
  EXPECT_NEAR(error.normal.mean_rad, 0, 1e-6);
}

TEST(DepthError, StatisticsOfAKnownDistribution) {
  const Truth truth = small_flat_truth();
  Image<float> depth(kSize, kSize);
  // Errors 0, 1, … 399 um.
  for (int i = 0; i < kSize * kSize; ++i)
    depth.pixels[static_cast<std::size_t>(i)] = 0.1f + 1e-6f * static_cast<float>(i);
  const DepthStatistics s = measure_depth_error(depth, truth, small_camera()).depth;
  EXPECT_NEAR(s.bias_m, 199.5e-6, 2e-8);
  EXPECT_NEAR(s.rms_m, std::sqrt(399.0 * 799 / 6) * 1e-6, 2e-8);
  EXPECT_NEAR(s.median_m, 200e-6, 1e-6);
  EXPECT_NEAR(s.p95_m, 379e-6, 1e-6);
  EXPECT_NEAR(s.max_m, 399e-6, 1e-7);
}

TEST(DepthError, SignIsFoundMinusTrue) {
  const Truth truth = small_flat_truth();
  const Image<float> deeper(kSize, kSize, 0.102f);
  EXPECT_NEAR(measure_depth_error(deeper, truth, small_camera()).depth.bias_m, 2e-3, 1e-8);
}

TEST(DepthError, MissedFalseAndOutsideTheFieldAreSeparate) {
  Truth truth = small_flat_truth();
  truth.kind.at(0, 0) = TruthKind::none;
  truth.kind.at(1, 0) = TruthKind::none;
  truth.kind.at(2, 0) = TruthKind::outside_field;
  Image<float> depth(kSize, kSize, 0.1f);
  depth.at(1, 0) = kNoSurface;  // rightly nothing
  for (int row = 3; row < 8; ++row) depth.at(5, row) = kNoSurface;
  const DepthError error = measure_depth_error(depth, truth, small_camera());
  EXPECT_EQ(error.missed, 5);
  EXPECT_EQ(error.false_surface, 1);
  EXPECT_EQ(error.outside_field, 1);
  EXPECT_EQ(error.depth.n, kSize * kSize - 3 - 5);
  EXPECT_DOUBLE_EQ(error.missed_percent(), 100.0 * 5 / 400);
  EXPECT_TRUE(std::isnan(error.map_m.at(5, 4)));
  EXPECT_TRUE(std::isnan(error.map_m.at(0, 0)));
}

TEST(DepthError, NormalErrorIsTheTilt) {
  Truth truth = small_flat_truth();
  const render::Camera camera = small_camera();
  const double pixel_m = camera.pixel_m();
  Image<float> tilted(kSize, kSize);
  for (int row = 0; row < kSize; ++row) {
    for (int column = 0; column < kSize; ++column) {
      tilted.at(column, row) = static_cast<float>(0.1 + column * pixel_m * std::tan(10 * kDegree));
    }
  }
  const DepthError error = measure_depth_error(tilted, truth, camera);
  EXPECT_NEAR(error.normal.mean_rad / kDegree, 10, 1e-3);
  EXPECT_NEAR(error.normal.p95_rad / kDegree, 10, 1e-2);
  EXPECT_EQ(error.normal.n, (kSize - 2) * (kSize - 2));
  // The normal of that tilt: no error.
  truth.normal = {kSize, kSize, glm::vec3(std::sin(10 * kDegree), 0, -std::cos(10 * kDegree))};
  EXPECT_NEAR(measure_depth_error(tilted, truth, camera).normal.mean_rad / kDegree, 0, 0.05)
      << "beyond the rounding of single-precision depths";
}

TEST(DepthError, OfNothingFoundIsUnset) {
  const DepthError error =
      measure_depth_error({kSize, kSize, kNoSurface}, small_flat_truth(), small_camera());
  EXPECT_EQ(error.depth.n, 0);
  EXPECT_TRUE(std::isnan(error.depth.bias_m));
  EXPECT_TRUE(std::isnan(error.normal.mean_rad));
  EXPECT_EQ(error.missed, kSize * kSize);
}

TEST(SurfaceArea, OfABallIsHalfItsAreaInParallelProjection) {
  const render::Camera camera = camera_of(512, render::Projection::parallel);
  const double radius_m = 0.03;
  const Truth truth = ball_truth(camera, 0.1, radius_m);
  const DepthError error = measure_depth_error(truth.depth_m, truth, camera);
  EXPECT_NEAR(error.surface_m2 / (2 * kPi * radius_m * radius_m), 1, 0.02) << "the rim is cut off";
  EXPECT_EQ(error.missed_surface_percent(), 0);
}

TEST(SurfaceArea, OfABallIsItsVisibleCapInPerspective) {
  const render::Camera camera = camera_of(512, render::Projection::perspective);
  const double radius_m = 0.03, distance_m = camera.eye_distance_m + 0.05;
  const Truth truth = ball_truth(camera, distance_m, radius_m);
  const DepthError error = measure_depth_error(truth.depth_m, truth, camera);
  const double cap_m2 = 2 * kPi * radius_m * radius_m * (1 - radius_m / distance_m);
  EXPECT_NEAR(error.surface_m2 / cap_m2, 1, 0.02);
}

/// Archimedes: rings of equal height have equal area. Only the cap about the middle is found.
TEST(SurfaceArea, MissedIsAShareOfTheSurfaceNotOfThePicture) {
  const render::Camera camera = camera_of(512, render::Projection::parallel);
  const double radius_m = 0.03;
  const Truth truth = ball_truth(camera, 0.1, radius_m);
  Image<float> found = truth.depth_m;
  for (std::size_t i = 0; i < found.pixels.size(); ++i) {
    if (truth.normal.pixels[i].z > -0.5f) found.pixels[i] = kNoSurface;  // beyond 60 degrees
  }
  const DepthError error = measure_depth_error(found, truth, camera);
  EXPECT_NEAR(error.missed_surface_percent(), 50, 1.5);
  const double ring = kPi * radius_m * radius_m * 0.25 / (0.1 * 0.1);
  EXPECT_NEAR(error.missed_percent(), 100 * ring, 0.3);
}

TEST(SurfaceArea, OfAPlaneFollowsDistanceAndTilt) {
  // Facing, in perspective: the picture's area, magnified.
  const render::Camera near = camera_of(64, render::Projection::perspective);
  const double ahead_m = 1.25 * near.eye_distance_m;
  Truth truth{{64, 64}, {64, 64, glm::vec3(0, 0, -1)}, {64, 64, TruthKind::surface}};
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 64; ++column) {
      truth.depth_m.at(column, row) =
          static_cast<float>(ahead_m / near.ray(column, row).direction.z);
    }
  }
  const double area_m2 = 1.25 * 1.25 * near.width_m * near.width_m;
  EXPECT_NEAR(measure_depth_error(truth.depth_m, truth, near).surface_m2 / area_m2, 1, 1e-6);
  // Tilted by 60 degrees, in parallel projection: twice the picture's area.
  const render::Camera far = camera_of(64, render::Projection::parallel);
  truth.normal = {64, 64, glm::vec3(std::sqrt(0.75f), 0, -0.5f)};
  EXPECT_NEAR(
      measure_depth_error(truth.depth_m, truth, far).surface_m2 / (2 * far.width_m * far.width_m),
      1,
      1e-6);
}

TEST(SurfaceArea, WithoutASurfaceNothingIsInView) {
  Truth truth = small_flat_truth();
  truth.kind = {kSize, kSize, TruthKind::none};
  const DepthError error = measure_depth_error({kSize, kSize, kNoSurface}, truth, small_camera());
  EXPECT_FALSE(error.surface_in_view());
  EXPECT_TRUE(std::isnan(error.missed_surface_percent()));
}

/// Of what is found, half is where nothing is.
TEST(SurfaceArea, FalseIsAShareOfWhatIsFound) {
  Truth truth = small_flat_truth();
  for (int row = 0; row < kSize; ++row) {
    for (int column = 0; column < kSize / 2; ++column) truth.kind.at(column, row) = TruthKind::none;
  }
  const render::Camera camera = small_camera();
  const DepthError error = measure_depth_error({kSize, kSize, 0.1f}, truth, camera);
  EXPECT_NEAR(error.found_m2 / (camera.width_m * camera.width_m), 1, 1e-6);
  EXPECT_NEAR(error.false_surface_percent(), 50, 1e-6);
  EXPECT_EQ(error.false_percent(), 50);
}

/// A false surface that is tilted by 60 degrees has twice the area of the true, facing one beside
/// it; both fill half of the picture.
TEST(SurfaceArea, OfWhatIsFoundFollowsItsSlope) {
  const render::Camera camera = camera_of(200, render::Projection::parallel);
  Truth truth = flat_truth(200);
  Image<float> found = truth.depth_m;
  const double rise_m = camera.pixel_m() * std::tan(60 * kDegree);
  for (int row = 0; row < 200; ++row) {
    for (int column = 0; column < 100; ++column) {
      truth.kind.at(column, row) = TruthKind::none;
      found.at(column, row) = static_cast<float>(0.2 + column * rise_m);
    }
  }
  const DepthError error = measure_depth_error(found, truth, camera);
  EXPECT_NEAR(error.false_surface_percent(), 100 * 2.0 / 3, 1) << "the border faces the viewer";
}

TEST(DepthError, WhatCannotBeSeenIsCountedApartByItsReason) {
  Truth truth = small_flat_truth();
  truth.crossing_m = truth.depth_m;
  truth.kind.at(3, 4) = TruthKind::shadowed;
  truth.kind.at(4, 4) = TruthKind::shadowed;
  truth.kind.at(5, 4) = TruthKind::grazing;
  for (const int column : {3, 4, 5}) truth.depth_m.at(column, 4) = kNoSurface;
  Image<float> found = truth.crossing_m;
  found.at(3, 4) = kNoSurface;
  found.at(4, 4) = 0.103f;
  const DepthError error = measure_depth_error(found, truth, small_camera());
  EXPECT_EQ(error.shadowed, 2);
  EXPECT_EQ(error.grazing, 1);
  EXPECT_EQ(error.surface, kSize * kSize - 3);
  EXPECT_EQ(error.missed, 0);
  EXPECT_EQ(error.false_surface, 0);
  EXPECT_EQ(error.depth.max_m, 0);
  EXPECT_NEAR(error.unseen_map_m.at(4, 4), 3e-3, 1e-8);
}

}  // namespace
}  // namespace wobblebench::bench
