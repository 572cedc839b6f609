// The error that the spacing of sticks adds, on surfaces whose ranges between sticks are known.
#include "bench/evaluation/bound/spacing_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/units.h"
#include "phantoms/phantom.h"

namespace wobblebench::bench {
namespace {

constexpr double kRadius_m = 20e-3;
const glm::dvec3 kCenter_m{0, 0, 0.12};

hw::AcquisitionPlan plan_of(int lines, int frames) {
  return {{}, {.sticks_per_frame = lines, .frames_per_volume = frames}};
}

render::View view_of(double yaw_rad = 0) {
  render::RenderOptions options;
  options.ray_casting.image_size = 65;  // one pixel is in the middle
  options.view.yaw_rad = yaw_rad;
  return render::make_view(options);
}

bool all(int /*column*/, int /*row*/) {
  return true;
}

SpacingError ball_error(const hw::AcquisitionPlan& plan, const render::View& view) {
  const auto ball = phantoms::still_at(
      phantoms::make_phantom({.name = "sphere", .radius_m = kRadius_m}), kCenter_m);
  const Truth truth = trace_truth(ball, plan, view);
  // Pixels that look at the ball, and that the probe sees, at less than 45 degrees.
  return spacing_error(
      truth, view.camera, plan, stick_ranges_m(ball, plan, view), [&](int column, int row) {
        const glm::dvec3 normal(truth.normal.at(column, row));
        return normal.z < -0.75 && glm::dot(view.camera.forward, normal) < -0.7;
      });
}

TEST(SpacingError, RangesOfSticksAreThoseOfTheSphere) {
  const auto plan = plan_of(33, 21);
  const auto ball = phantoms::still_at(
      phantoms::make_phantom({.name = "sphere", .radius_m = kRadius_m}), kCenter_m);
  const Image<float> ranges_m = stick_ranges_m(ball, plan, view_of());
  EXPECT_NEAR(static_cast<double>(ranges_m.at(16, 10)), 0.12 - 0.04 - kRadius_m, 1e-5);
  const hw::Ray ray = plan.geometry().stick(plan.theta_rad(18), plan.frame_phi_rad(11));
  const double along = glm::dot(kCenter_m - ray.origin, ray.direction);
  const double off = glm::length(ray.at(along) - kCenter_m);
  EXPECT_NEAR(static_cast<double>(ranges_m.at(18, 11)),
              along - std::sqrt(kRadius_m * kRadius_m - off * off),
              2e-5);
  EXPECT_TRUE(std::isnan(ranges_m.at(0, 0)));
}

// A chord of a convex surface lies behind it, and half the spacing makes a quarter of the error.
TEST(SpacingError, OfABallFallsWithTheSquareOfTheSpacing) {
  for (const double yaw_rad : {0.0, 20 * kDegree}) {
    const SpacingError coarse = ball_error(plan_of(97, 97), view_of(yaw_rad));
    const SpacingError fine = ball_error(plan_of(193, 193), view_of(yaw_rad));
    ASSERT_GT(coarse.n, 100);
    EXPECT_NEAR(coarse.rms_m / fine.rms_m, 4, 0.5);
    for (const float error_m : coarse.map_m.pixels) {
      EXPECT_FALSE(error_m < -20e-6F) << error_m;  // nor for NaN
    }
  }
}

// On the axis the ball has the curvature 1 / radius against a plane; ranges of sticks that fan out
// from 40 mm before the face curve by 1 / (a + range) the other way.
TEST(SpacingError, OnTheAxisIsTheChordsError) {
  const auto plan = plan_of(64, 64);
  const SpacingError error = ball_error(plan, view_of());
  const double range_m = 0.12 - kRadius_m;  // from the centre of the face
  const double lateral_m = range_m * plan.theta_step_rad();
  const double elevation_m = (range_m - plan.geometry().axis_z_m()) * plan.phi_step_rad();
  // Ranges r of a plane z = r cos(angle) have the second derivative r by the angle.
  const double in_plane = (1 / kRadius_m + 1 / range_m) * lateral_m * lateral_m / 8;
  const double across =
      (1 / kRadius_m + 1 / (range_m - plan.geometry().axis_z_m())) * elevation_m * elevation_m / 8;
  // Even numbers of lines and frames: the axis lies midway between four sticks.
  const double middle_m = static_cast<double>(error.map_m.at(32, 32));
  EXPECT_NEAR(middle_m, in_plane + across, 0.1 * (in_plane + across));
}

TEST(SpacingError, LeavesOutWhatNoFourSticksSupport) {
  const auto plan = plan_of(9, 7);
  const auto ball = phantoms::still_at(
      phantoms::make_phantom({.name = "sphere", .radius_m = kRadius_m}), kCenter_m);
  const auto view = view_of();
  const Truth truth = trace_truth(ball, plan, view);
  const SpacingError error =
      spacing_error(truth, view.camera, plan, stick_ranges_m(ball, plan, view), all);
  EXPECT_GT(error.unsupported, 0);
  const SpacingError none = spacing_error(
      truth, view.camera, plan, stick_ranges_m(ball, plan, view), [](int, int) { return false; });
  EXPECT_EQ(none.n, 0);
  EXPECT_TRUE(std::isnan(none.rms_m));
}

}  // namespace
}  // namespace wobblebench::bench
