// Error measures of depth images with known errors.
#include "bench/evaluation/depth_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/camera.h"

namespace wobblebench::bench {
namespace {

constexpr int kSize = 20;

render::Camera small_camera() {
  render::RenderOptions options;
  options.ray_casting.image_size = kSize;
  return render::make_camera(options);
}

/// A flat true surface at 0.1 m that faces the viewer and fills the picture.
Truth flat_truth() {
  return {{kSize, kSize, 0.1f},
          {kSize, kSize, glm::vec3(0, 0, -1)},
          {kSize, kSize, TruthKind::surface}};
}

TEST(DepthError, OfThePerfectPictureIsZero) {
  const Truth truth = flat_truth();
  const DepthError error = measure_depth_error(truth.depth_m, truth, small_camera());
  EXPECT_EQ(error.depth.n, kSize * kSize);
  EXPECT_EQ(error.depth.rms_m, 0);
  EXPECT_EQ(error.depth.max_m, 0);
  EXPECT_EQ(error.missed, 0);
  EXPECT_EQ(error.false_surface, 0);
  EXPECT_NEAR(error.normal.mean_rad, 0, 1e-6);
}

TEST(DepthError, StatisticsOfAKnownDistribution) {
  const Truth truth = flat_truth();
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
  const Truth truth = flat_truth();
  const Image<float> deeper(kSize, kSize, 0.102f);
  EXPECT_NEAR(measure_depth_error(deeper, truth, small_camera()).depth.bias_m, 2e-3, 1e-8);
}

TEST(DepthError, MissedFalseAndOutsideTheFieldAreSeparate) {
  Truth truth = flat_truth();
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
  Truth truth = flat_truth();
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
      measure_depth_error({kSize, kSize, kNoSurface}, flat_truth(), small_camera());
  EXPECT_EQ(error.depth.n, 0);
  EXPECT_TRUE(std::isnan(error.depth.bias_m));
  EXPECT_TRUE(std::isnan(error.normal.mean_rad));
  EXPECT_EQ(error.missed, kSize * kSize);
}

}  // namespace
}  // namespace wobblebench::bench
