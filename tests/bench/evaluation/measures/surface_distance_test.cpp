// Distances in space, of surfaces with known ones.
#include "bench/evaluation/measures/surface_distance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/bench/evaluation/measures/made_up_truth.h"

namespace wobblebench::bench {
namespace {

constexpr int kSide = 20;  // pixels of 5 mm

TEST(TriangleDistance, ToFaceEdgeAndCorner) {
  const glm::dvec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  EXPECT_NEAR(triangle_distance_m({0.2, 0.2, 3}, a, b, c), 3, 1e-12);
  EXPECT_NEAR(triangle_distance_m({0.5, -2, 0}, a, b, c), 2, 1e-12);
  EXPECT_NEAR(triangle_distance_m({1, 1, 0}, a, b, c), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(triangle_distance_m({-3, -4, 0}, a, b, c), 5, 1e-12);
}

TEST(SurfaceDistance, OfAShiftedPlaneIsTheShift) {
  const render::Camera camera = camera_of(kSide, render::Projection::parallel);
  const SurfaceDistance d = surface_distance({kSide, kSide, 0.102f}, flat_truth(kSide), camera);
  EXPECT_EQ(d.found_to_true.n, kSide * kSide);
  EXPECT_EQ(d.true_to_found.n, kSide * kSide);
  for (const double distance_m :
       {d.mean_m, d.p95_m, d.hausdorff95_m, d.found_to_true.max_m, d.true_to_found.mean_m}) {
    EXPECT_NEAR(distance_m, 2e-3, 1e-8);
  }
}

/// Along the rays both planes are 2 mm apart; in space less by the cosine. Vertices alone are never
/// nearer than 2 mm along the ray, or a pixel across.
TEST(SurfaceDistance, OfATiltedPlaneIsPerpendicular) {
  const int size = 100;  // pixels of 1 mm
  const render::Camera camera = camera_of(size, render::Projection::parallel);
  Truth truth = flat_truth(size);
  Image<float> found(size, size);
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const double depth_m = 0.1 + column * camera.pixel_m() * std::tan(50 * kDegree);
      truth.depth_m.at(column, row) = static_cast<float>(depth_m);
      found.at(column, row) = static_cast<float>(depth_m + 2e-3);
    }
  }
  const SurfaceDistance d = surface_distance(found, truth, camera);
  const double expected_m = 2e-3 * std::cos(50 * kDegree);
  EXPECT_NEAR(d.true_to_found.p95_m, expected_m, 1e-7);
  EXPECT_NEAR(d.found_to_true.p95_m, expected_m, 1e-7);
}

TEST(SurfaceDistance, BetweenConcentricBallsIsTheDifferenceOfTheirRadii) {
  const render::Camera camera = camera_of(256, render::Projection::parallel);
  const Truth small = ball_truth(camera, 0.1, 30e-3), large = ball_truth(camera, 0.1, 31.5e-3);
  const DepthSurface around(large.depth_m, camera);
  const DepthSurface within(small.depth_m, camera);
  int compared = 0;
  for (int i = 0; i < 256 * 256; ++i) {
    const auto at = static_cast<std::size_t>(i);
    // Towards the rim triangles end, where depths jump by more than they may.
    if (small.normal.pixels[at].z > -0.5f || std::isnan(small.depth_m.pixels[at])) continue;
    const glm::dvec3 point =
        camera.ray(i % 256, i / 256).at(static_cast<double>(small.depth_m.pixels[at]));
    ASSERT_NEAR(around.distance_m(point), 1.5e-3, 0.01e-3);
    ++compared;
  }
  EXPECT_GT(compared, 5000);
}

/// A strip of two of the 20 columns is found 20 mm too deep. From there to the true surface: 20 mm,
/// a tenth of all. From the true strip to what is found: one or two pixels of 5 mm aside.
TEST(SurfaceDistance, Hausdorff95OfTwoKnownSets) {
  const render::Camera camera = camera_of(kSide, render::Projection::parallel);
  Image<float> found(kSide, kSide, 0.1f);
  for (int row = 0; row < kSide; ++row) found.at(0, row) = found.at(1, row) = 0.12f;
  const SurfaceDistance d = surface_distance(found, flat_truth(kSide), camera);
  EXPECT_NEAR(d.found_to_true.p95_m, 20e-3, 1e-8);
  EXPECT_NEAR(d.found_to_true.mean_m, 2e-3, 1e-8);
  // Between the last of the points 5 mm away, index 379 of 400, and the first 10 mm away.
  EXPECT_NEAR(d.true_to_found.p95_m, 5.25e-3, 1e-8);
  EXPECT_NEAR(d.true_to_found.max_m, 10e-3, 1e-8);
  EXPECT_NEAR(d.true_to_found.mean_m, 0.75e-3, 1e-8);
  EXPECT_NEAR(d.hausdorff95_m, 20e-3, 1e-8);
  EXPECT_NEAR(d.mean_m, 1.375e-3, 1e-8);
}

TEST(SurfaceDistance, IsUnsetWhereNothingIsFoundOrThere) {
  const render::Camera camera = camera_of(kSide, render::Projection::parallel);
  const SurfaceDistance d = surface_distance({kSide, kSide, kNoSurface}, flat_truth(kSide), camera);
  EXPECT_EQ(d.found_to_true.n, 0);
  EXPECT_TRUE(std::isnan(d.hausdorff95_m));
  EXPECT_TRUE(std::isnan(d.mean_m));
}

}  // namespace
}  // namespace wobblebench::bench
