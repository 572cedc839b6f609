// What alignment is for: a slope scanned by few sticks is a slope, not a staircase.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "render/camera.h"
#include "render/renderer.h"
#include "tests/render/support/gl_fixture.h"
#include "tests/render/support/synthetic.h"

namespace wobblebench::render {
namespace {

constexpr double kRadius_m = 0.03;
const glm::dvec3 kCenter{0, 0, 0.12};

struct BallError {
  double rms_m = 0;       ///< of z
  double normal_rad = 0;  ///< mean angle between the normals of z and the ball's
};

/// Against the ball's closed form, where the surface is met at less than 60 degrees.
BallError ball_error(const hw::PolarVolume& volume, const RenderOptions& options) {
  const Picture picture = render_volume(testing::gl_context(), volume, options);
  const Camera camera = make_camera(options);
  const auto point = [&](int column, int row) {
    return camera.ray(column, row).at(static_cast<double>(picture.depth_m.at(column, row)));
  };
  BallError error;
  int count = 0, missed = 0;
  for (int row = 1; row + 1 < camera.image_size; ++row) {
    for (int column = 1; column + 1 < camera.image_size; ++column) {
      const hw::Ray ray = camera.ray(column, row);
      const double beside_m = glm::length(glm::cross(kCenter - ray.origin, ray.direction));
      if (beside_m > kRadius_m * std::sin(60 * kDegree)) continue;
      const double true_m = glm::dot(kCenter - ray.origin, ray.direction) -
                            std::sqrt(kRadius_m * kRadius_m - beside_m * beside_m);
      const glm::dvec3 across = glm::cross(point(column, row + 1) - point(column, row - 1),
                                           point(column + 1, row) - point(column - 1, row));
      const double found_m = static_cast<double>(picture.depth_m.at(column, row));
      if (!std::isfinite(found_m) || !(glm::length(across) > 0)) {
        ++missed;
        continue;
      }
      const glm::dvec3 outward = (ray.at(true_m) - kCenter) / kRadius_m;
      const double cosine = glm::dot(glm::normalize(across), outward);
      error.normal_rad += std::acos(std::clamp(cosine, -1.0, 1.0));
      error.rms_m += (found_m - true_m) * (found_m - true_m);
      ++count;
    }
  }
  EXPECT_EQ(missed, 0);
  return {std::sqrt(error.rms_m / count), error.normal_rad / count};
}

TEST(AlignedSticks, MakeABallRounderThanPlainOnes) {
  const hw::AcquisitionPlan plan({}, {});  // the paper's scan: sticks 2 to 4 mm apart
  const hw::PolarVolume volume =
      testing::sample_field(plan, testing::sphere(kCenter, kRadius_m, 1e-3));
  RenderOptions options;
  options.ray_casting.detector = Detector::iso;
  options.ray_casting.iso_level = 0.5;
  options.ray_casting.image_size = 128;
  options.volume_of_interest = {kCenter, {0.08, 0.08, 0.08}};
  const BallError plain = ball_error(volume, options);
  options.reconstruction.sticks = Sticks::aligned;
  const BallError aligned = ball_error(volume, options);
  EXPECT_LT(aligned.normal_rad, 0.5 * plain.normal_rad);
  EXPECT_LT(aligned.rms_m, plain.rms_m);
  EXPECT_LT(aligned.rms_m, 0.25e-3);
}

}  // namespace
}  // namespace wobblebench::render
