// Divisions of the picture, and errors within them.
#include "bench/evaluation/measures/regions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "bench/evaluation/measures/picture_measures.h"
#include "bench/results/error.h"
#include "tests/bench/evaluation/measures/made_up_truth.h"

namespace wobblebench::bench {
namespace {

double share(const Image<std::uint8_t>& band) {
  return std::accumulate(band.pixels.begin(), band.pixels.end(), 0.0) /
         static_cast<double>(band.pixels.size());
}

/// The rim is a circle; a band of 3 mm on either side of it is a ring of area 4 pi R B.
TEST(SilhouetteBand, OfABallIsARing) {
  const render::Camera camera = camera_of(512, render::Projection::parallel);
  const double radius_m = 30e-3;
  const auto band = silhouette_band(ball_truth(camera, 0.1, radius_m), camera);
  const double ring_m2 = 4 * kPi * radius_m * kBandWidth_m;
  EXPECT_NEAR(share(band) * camera.width_m * camera.width_m / ring_m2, 1, 0.03);
}

/// Magnified: the rim, seen from the eye, is nearer than the picture's plane or farther.
TEST(SilhouetteBand, InPerspectiveIsAsWideAtTheSurface) {
  const render::Camera camera = camera_of(512, render::Projection::perspective);
  const double radius_m = 20e-3, ahead_m = 1.5 * camera.eye_distance_m;
  const Truth truth = ball_truth(camera, ahead_m, radius_m);
  const auto band = silhouette_band(truth, camera);
  int within = 0;
  for (std::size_t i = 0; i < band.pixels.size(); ++i) {
    within += band.pixels[i] == 1 && truth.kind.pixels[i] == TruthKind::surface;
  }
  const double side_m = camera.pixel_m() * 1.5;
  const double ring_m2 = kPi * (2 * radius_m - kBandWidth_m) * kBandWidth_m;
  EXPECT_NEAR(within * side_m * side_m / ring_m2, 1, 0.05);
}

TEST(SilhouetteBand, IsAboutAJumpOfDepthAndNotAboutASmallerOne) {
  const render::Camera camera = camera_of(200, render::Projection::parallel);  // 0.5 mm
  Truth truth = flat_truth(200);
  for (int row = 0; row < 200; ++row) {
    for (int column = 0; column < 100; ++column) truth.depth_m.at(column, row) = 0.1029f;
  }
  EXPECT_EQ(share(silhouette_band(truth, camera)), 0);
  for (float& depth : truth.depth_m.pixels) depth = depth > 0.1f ? 0.104f : depth;
  // 6 mm of 100.
  EXPECT_NEAR(share(silhouette_band(truth, camera)), 0.06, 1e-9);
}

TEST(SilhouetteBand, IsAboutWhatIsGrazing) {
  const render::Camera camera = camera_of(200, render::Projection::parallel);
  Truth truth = flat_truth(200);
  truth.crossing_m = truth.depth_m;
  truth.kind.at(50, 100) = TruthKind::grazing;
  const auto band = silhouette_band(truth, camera);
  EXPECT_NEAR(share(band) * 200 * 200, kPi * 5.5 * 5.5, 5) << "3 mm from its sides";
  truth.kind.at(50, 100) = TruthKind::outside_field;
  EXPECT_EQ(share(silhouette_band(truth, camera)), 0);
}

/// A truth with two known halves: the left at 10 degrees of incidence, the right at 50.
Truth halves(int size) {
  Truth truth = flat_truth(size);
  truth.crossing_m = truth.depth_m;
  truth.incidence_rad = {size, size, static_cast<float>(10 * kDegree)};
  truth.range_m = {size, size, 0.055f};
  truth.part = {size, size, 12};
  truth.parts = {{4, "nose"}, {12, "cheek"}};
  for (int row = 0; row < size; ++row) {
    for (int column = size / 2; column < size; ++column) {
      truth.incidence_rad.at(column, row) = static_cast<float>(50 * kDegree);
      truth.part.at(column, row) = 4;
    }
  }
  return truth;
}

const RegionError& find(const std::vector<RegionError>& errors,
                        const std::string& group,
                        const std::string& name) {
  return *std::find_if(errors.begin(), errors.end(), [&](const RegionError& e) {
    return e.group == group && e.name == name;
  });
}

TEST(Regions, SeparateErrorsByIncidenceRangeAndPart) {
  const render::Camera camera = camera_of(20, render::Projection::parallel);
  const Truth truth = halves(20);
  Image<float> found = truth.depth_m;
  for (int row = 0; row < 20; ++row) {
    for (int column = 10; column < 20; ++column) found.at(column, row) += 1e-3f;
    found.at(15, row) = kNoSurface;
  }
  const DepthError raw = measure_depth_error(found, truth, camera);
  const auto errors = measure_regions(region_groups(truth, camera), truth, camera, found, raw, raw);
  EXPECT_EQ(find(errors, "incidence", "0-20").surface, 200);
  EXPECT_EQ(find(errors, "incidence", "0-20").depth.max_m, 0);
  const RegionError& steep = find(errors, "incidence", "40-60");
  EXPECT_NEAR(steep.depth.bias_m, 1e-3, 1e-8);
  EXPECT_EQ(steep.missed, 20);
  EXPECT_NEAR(steep.missed_surface_percent(), 10, 1e-9);
  EXPECT_EQ(find(errors, "range", "40-60").surface, 400);
  EXPECT_NEAR(find(errors, "part", "nose").depth.bias_m, 1e-3, 1e-8);
  EXPECT_EQ(find(errors, "part", "cheek").depth.bias_m, 0);
  EXPECT_EQ(find(errors, "silhouette", "outside").surface, 400);
  const PictureMeasures measures{
      .raw = raw, .filtered = raw, .shaded = {}, .regions = errors, .distance = {}};
  const Measurements described_as = described(measures, ExpectedSurface());
  EXPECT_NEAR(described_as.value(error::kNoseP95), 1, 1e-5) << "the cheek is no feature";
  EXPECT_NEAR(described_as.value(error::kNoseMissed), 10, 1e-9);
  EXPECT_TRUE(std::isnan(described_as.value(error::kMouthP95)));
  EXPECT_TRUE(std::isnan(described_as.value(error::kMouthMissed)));
}

TEST(Regions, OfAGroupAddUpToThePicture) {
  const render::Camera camera = camera_of(128, render::Projection::parallel);
  const Truth truth = ball_truth(camera, 0.1, 30e-3);
  const Truth larger = ball_truth(camera, 0.1, 33e-3);
  Image<float> found = larger.depth_m;
  for (int row = 60; row < 70; ++row) found.at(64, row) = kNoSurface;
  const DepthError raw = measure_depth_error(found, truth, camera);
  const auto errors = measure_regions(region_groups(truth, camera), truth, camera, found, raw, raw);
  const RegionError& outside = find(errors, "silhouette", "outside");
  const RegionError& within = find(errors, "silhouette", "within");
  EXPECT_EQ(outside.surface + within.surface, raw.surface);
  EXPECT_EQ(outside.missed + within.missed, raw.missed);
  EXPECT_EQ(outside.missed, 10);
  EXPECT_EQ(outside.false_surface + within.false_surface, raw.false_surface);
  EXPECT_GT(within.false_surface, 0);
  EXPECT_NEAR(outside.surface_m2 + within.surface_m2, raw.surface_m2, 1e-6 * raw.surface_m2);
}

}  // namespace
}  // namespace wobblebench::bench
