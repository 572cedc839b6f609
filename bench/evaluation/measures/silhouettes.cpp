#include "bench/evaluation/measures/silhouettes.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/evaluation/measures/depth_error.h"

namespace wobblebench::bench {

namespace {

bool differs(const Truth& truth, int column, int row, int next_column, int next_row) {
  if (next_column >= truth.kind.width || next_row >= truth.kind.height) return false;
  const float here = truth.any_depth_m(column, row);
  const float there = truth.any_depth_m(next_column, next_row);
  if (std::isnan(here) != std::isnan(there)) return true;
  return std::abs(here - there) > static_cast<float>(kSurfaceJump_m);
}

/// Zero at the silhouettes, as cv::distanceTransform takes it.
cv::Mat1b away_from_silhouettes(const Truth& truth) {
  cv::Mat1b away(truth.kind.height, truth.kind.width, std::uint8_t{1});
  for (int row = 0; row < truth.kind.height; ++row) {
    for (int column = 0; column < truth.kind.width; ++column) {
      if (truth.kind.at(column, row) == TruthKind::grazing) away(row, column) = 0;
      for (const auto& [c, r] : {std::pair{column + 1, row}, std::pair{column, row + 1}}) {
        if (differs(truth, column, row, c, r)) away(row, column) = away(r, c) = 0;
      }
    }
  }
  return away;
}

/// Side of a pixel at its true surface; at the middle of the scene where there is none.
double side_m(const Truth& truth, const render::Camera& camera, int column, int row) {
  if (camera.projection == render::Projection::parallel) return camera.pixel_m();
  const auto depth_m = static_cast<double>(truth.any_depth_m(column, row));
  return camera.pixel_m() * (std::isnan(depth_m) ? 1 : depth_m / camera.eye_distance_m);
}

}  // namespace

Image<std::uint8_t> silhouette_band(const Truth& truth,
                                    const render::Camera& camera,
                                    double width_m) {
  const int width = truth.kind.width, height = truth.kind.height;
  const cv::Mat1b away = away_from_silhouettes(truth);
  Image<std::uint8_t> band(width, height, 0);
  if (cv::countNonZero(away) == width * height) return band;  // no silhouette in the picture
  cv::Mat1f pixels;
  cv::distanceTransform(away, pixels, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      // A silhouette runs between two pixels, half a pixel from the middle of each.
      const double across_m =
          (0.5 + static_cast<double>(pixels(row, column))) * side_m(truth, camera, column, row);
      band.at(column, row) = across_m <= width_m * (1 + 1e-9) ? 1 : 0;
    }
  }
  return band;
}

}  // namespace wobblebench::bench
