#include "render/passes/outline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/camera.h"
#include "render/picture.h"

namespace wobblebench::render {
namespace {

constexpr int kPixels = 200;
constexpr double kBall_m = 30e-3;
const glm::dvec3 kCentre{0, 0, 0.115};

/// A picture of pixels of half a millimetre.
RenderOptions smoothed_by(double outline_mm) {
  RenderOptions options;
  options.ray_casting.image_size = kPixels;
  options.ray_casting.outline_m = outline_mm * 1e-3;
  return options;
}

hw::ProbeGeometry geometry() {
  return hw::ProbeGeometry{hw::ProbeOptions{}};
}

/// The near side of a ball, in closed form, out to this distance from its axis at each angle about
/// it.
template <class Reach>
Image<double> ball(const RenderOptions& options, const Reach& reach_m) {
  const Camera camera = make_camera(options);
  Image<double> depth_m(kPixels, kPixels, kNoSurface);
  for (int row = 0; row < kPixels; ++row) {
    for (int column = 0; column < kPixels; ++column) {
      const glm::dvec3 at = camera.ray(column, row).origin - kCentre;
      const double out_m = std::hypot(at.x, at.y);
      if (out_m > reach_m(std::atan2(at.y, at.x))) continue;
      depth_m.at(column, row) = -at.z - std::sqrt(kBall_m * kBall_m - out_m * out_m);
    }
  }
  return depth_m;
}

/// Root mean square distance of the outline's radius from its mean over all angles.
double roughness_m(const Image<double>& depth_m, const RenderOptions& options) {
  const double pixel_m = make_camera(options).pixel_m();
  std::vector<double> radii_m;
  for (int k = 0; k < 360; ++k) {
    int steps = 0;
    const double angle = k * kDegree;
    const auto has = [&](int step) {
      const double out = 0.25 * step;
      return std::isfinite(depth_m.at(static_cast<int>(100 + out * std::cos(angle)),
                                      static_cast<int>(100 + out * std::sin(angle))));
    };
    while (has(steps)) ++steps;
    radii_m.push_back(0.25 * steps * pixel_m);
  }
  double mean_m = 0, square = 0;
  for (const double r : radii_m) mean_m += r / 360;
  for (const double r : radii_m) square += (r - mean_m) * (r - mean_m) / 360;
  return std::sqrt(square);
}

/// Of the ball's 30 mm 28.5 are found, where its normal is 72 degrees from the view, with tufts.
double tufts(double angle) {
  return 28.5e-3 + 1e-3 * std::sin(25 * angle);
}

TEST(Outline, OfASteepRimIsSmoothed) {
  const RenderOptions options = smoothed_by(4);
  const Image<double> found_m = ball(options, tufts);
  const Image<double> depth_m = finished_surface(found_m, geometry(), options);
  EXPECT_GT(roughness_m(found_m, options), 0.6e-3);   // 1 mm over the root of 2
  EXPECT_LT(roughness_m(depth_m, options), 0.25e-3);  // pixels are half a millimetre wide
}

TEST(Outline, WhatIsDrawnContinuesTheSurface) {
  const RenderOptions options = smoothed_by(4);
  const Image<double> found_m = ball(options, tufts);
  const Image<double> depth_m = finished_surface(found_m, geometry(), options);
  const Image<std::uint8_t> drawn = drawn_beyond(found_m, depth_m);
  const Image<double> whole_m = ball(options, [](double) { return 29.9e-3; });
  int count = 0;
  for (std::size_t i = 0; i < drawn.pixels.size(); ++i) {
    if (drawn.pixels[i] == 0) {
      EXPECT_TRUE(std::isnan(depth_m.pixels[i]) || depth_m.pixels[i] == found_m.pixels[i]);
      continue;
    }
    ++count;
    EXPECT_NEAR(depth_m.pixels[i], whole_m.pixels[i], 2e-3);
  }
  EXPECT_GT(count, 100);
}

TEST(Outline, OfAGentleSlopeStays) {
  const RenderOptions options = smoothed_by(4);
  const auto found_m =
      ball(options, [](double angle) { return 18e-3 + 1e-3 * std::sin(25 * angle); });
  const auto depth_m = finished_surface(found_m, geometry(), options);
  for (const std::uint8_t is : drawn_beyond(found_m, depth_m).pixels) ASSERT_EQ(is, 0);
  for (const std::uint8_t was : drawn_beyond(depth_m, found_m).pixels) ASSERT_EQ(was, 0);
}

TEST(Outline, OfAThinBodyIsNotCutOff) {
  const RenderOptions options = smoothed_by(4);
  const Camera camera = make_camera(options);
  Image<double> found_m(kPixels, kPixels, kNoSurface);
  for (int row = 40; row < 160; ++row) {
    for (int column = 96; column < 104; ++column) {  // a cylinder, 4 mm thick
      const double across_m = camera.ray(column, row).origin.x;
      found_m.at(column, row) = 0.1 - std::sqrt(2.05e-3 * 2.05e-3 - across_m * across_m);
    }
  }
  const auto depth_m = finished_surface(found_m, geometry(), options);
  for (const std::uint8_t was : drawn_beyond(depth_m, found_m).pixels) ASSERT_EQ(was, 0);
}

/// As that of an ear and the neck behind it.
TEST(Outline, OfACornerBetweenTwoSurfacesContinuesNeither) {
  const RenderOptions options = smoothed_by(4);
  Image<double> found_m = ball(options, [](double) { return 28.5e-3; });
  const Camera camera = make_camera(options);
  constexpr double kBehind_m = 0.1;
  for (int row = 0; row < kPixels; ++row) {
    for (int column = 0; column < kPixels; ++column) {
      double& z_m = found_m.at(column, row);
      if (std::isnan(z_m) && camera.ray(column, row).origin.y > 15e-3) z_m = kBehind_m;
    }
  }
  const auto depth_m = finished_surface(found_m, geometry(), options);
  const auto drawn = drawn_beyond(found_m, depth_m);
  const auto whole_m = ball(options, [](double) { return 29.9e-3; });
  for (std::size_t i = 0; i < drawn.pixels.size(); ++i) {
    if (drawn.pixels[i] == 0) continue;
    const double of_ball_m = std::abs(depth_m.pixels[i] - whole_m.pixels[i]);
    EXPECT_TRUE(of_ball_m < 2e-3 || std::abs(depth_m.pixels[i] - kBehind_m) < 2e-3) << i;
  }
}

TEST(Outline, StaysWithoutTheOption) {
  const RenderOptions options = smoothed_by(0);
  const Image<double> found_m = ball(options, tufts);
  const Image<double> depth_m = finished_surface(found_m, geometry(), options);
  for (std::size_t i = 0; i < found_m.pixels.size(); ++i) {
    ASSERT_TRUE(depth_m.pixels[i] == found_m.pixels[i] || std::isnan(found_m.pixels[i]));
  }
}

}  // namespace
}  // namespace wobblebench::render
