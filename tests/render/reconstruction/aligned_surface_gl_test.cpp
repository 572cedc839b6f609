// What alignment is for: a slope scanned by few sticks is a slope, not a staircase.
#include <gtest/gtest.h>

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

/// RMS of z against the ball's closed form, where the surface is met at less than 60 degrees.
double ball_error_m(const hw::PolarVolume& volume, const RenderOptions& options) {
  const Picture picture = render_volume(testing::gl_context(), volume, options);
  const Camera camera = make_camera(options);
  double squares = 0;
  int count = 0, missed = 0;
  for (int row = 0; row < camera.image_size; ++row) {
    for (int column = 0; column < camera.image_size; ++column) {
      const hw::Ray ray = camera.ray(column, row);
      const double beside_m = glm::length(glm::cross(kCenter - ray.origin, ray.direction));
      if (beside_m > kRadius_m * std::sin(60 * kDegree)) continue;
      const double true_m = glm::dot(kCenter - ray.origin, ray.direction) -
                            std::sqrt(kRadius_m * kRadius_m - beside_m * beside_m);
      const double found_m = static_cast<double>(picture.depth_m.at(column, row));
      if (!std::isfinite(found_m)) {
        ++missed;
        continue;
      }
      squares += (found_m - true_m) * (found_m - true_m);
      ++count;
    }
  }
  EXPECT_EQ(missed, 0);
  return std::sqrt(squares / count);
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
  const double plain_m = ball_error_m(volume, options);
  options.reconstruction.sticks = Sticks::aligned;
  const double aligned_m = ball_error_m(volume, options);
  EXPECT_LT(aligned_m, 0.5 * plain_m);
  EXPECT_LT(aligned_m, 0.3e-3);
}

}  // namespace
}  // namespace wobblebench::render
