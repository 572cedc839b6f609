#include "render/passes/pieces.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/camera.h"

namespace wobblebench::render {
namespace {

constexpr int kSide = 20;

/// A picture of pixels of one millimetre.
RenderOptions options_of(double least_mm2) {
  RenderOptions options;
  options.ray_casting.image_size = kSide;
  options.ray_casting.smallest_piece_m2 = least_mm2 * 1e-6;
  const double width_m = make_camera(options).width_m;
  options.volume_of_interest.size_m *= kSide * 1e-3 / width_m;
  return options;
}

void fill(Image<double>& depth_m, int column, int row, int columns, int rows, double z_m) {
  for (int r = row; r < row + rows; ++r) {
    for (int c = column; c < column + columns; ++c) depth_m.at(c, r) = z_m;
  }
}

int pixels_with_surface(const Image<double>& depth_m) {
  int count = 0;
  for (const double z : depth_m.pixels) count += std::isfinite(z);
  return count;
}

TEST(Pieces, OfLessThanTheAreaAreLeftOut) {
  ASSERT_NEAR(make_camera(options_of(1)).pixel_m(), 1e-3, 1e-9);
  Image<double> depth_m(kSide, kSide, kNoSurface);
  fill(depth_m, 0, 0, 4, 3, 0.1);    // 12 mm2
  fill(depth_m, 10, 10, 3, 3, 0.1);  // 9 mm2
  fill(depth_m, 13, 13, 1, 1, 0.1);  // touches it at a corner alone
  Image<double> kept = depth_m;
  drop_small_pieces(kept, options_of(9.5));
  EXPECT_EQ(pixels_with_surface(kept), 12);
  EXPECT_TRUE(std::isfinite(kept.at(0, 0)));
  kept = depth_m;
  drop_small_pieces(kept, options_of(8.5));
  EXPECT_EQ(pixels_with_surface(kept), 21);
  kept = depth_m;
  drop_small_pieces(kept, options_of(0));
  EXPECT_EQ(pixels_with_surface(kept), 22);
}

TEST(Pieces, EndWhereDepthSteps) {
  Image<double> depth_m(kSide, kSide, kNoSurface);
  fill(depth_m, 0, 0, 10, 10, 0.1);
  fill(depth_m, 4, 4, 2, 2, 0.09);  // floats 10 mm before it
  drop_small_pieces(depth_m, options_of(5));
  EXPECT_EQ(pixels_with_surface(depth_m), 96);
  fill(depth_m, 4, 4, 2, 2, 0.097);  // a bump of 3 mm
  drop_small_pieces(depth_m, options_of(5));
  EXPECT_EQ(pixels_with_surface(depth_m), 100);
}

}  // namespace
}  // namespace wobblebench::render
