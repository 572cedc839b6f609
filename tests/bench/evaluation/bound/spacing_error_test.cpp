// The error that the spacing of sticks adds, on surfaces whose ranges between sticks are known.
#include "bench/evaluation/bound/spacing_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

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

bool every_pixel(int /*column*/, int /*row*/) {
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
  const Image<float> ranges_m = stick_ranges_m(ball, plan, view_of()).ranges_m;
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

// Between sticks on two treads nothing joins them; on a tread the error is that of a plane, whose
// ranges curve by at most range / cos^3 of the stick's angle.
TEST(SpacingError, AcrossAStepSticksAreParted) {
  const auto plan = plan_of(64, 38);
  const auto steps = phantoms::still_at(
      phantoms::make_phantom({.name = "steps", .step_heights_m = {8e-3}}), {0, 0, 0.12});
  const auto view = view_of();
  const Truth truth = trace_truth(steps, plan, view);
  const SpacingError error =
      spacing_error(truth, view.camera, plan, stick_ranges_m(steps, plan, view), every_pixel);
  // The edge crosses all 65 rows, nearly all within the sweep; the sticks on its sides are one to
  // three pixels apart.
  EXPECT_GT(error.parted, 0.75 * 65);
  EXPECT_LT(error.parted, 3 * 65);
  EXPECT_GT(error.n, 10 * error.hidden);
  EXPECT_EQ(error.unsupported, error.hidden + error.outside + error.parted);
  const auto bend_m = [](double range_m, double step_rad, double angle_rad) {
    const double cosine = std::cos(angle_rad);
    return range_m * step_rad * step_rad / 8 * 2 / (cosine * cosine * cosine);
  };
  const double deepest_m = 0.13;
  const double largest_m = bend_m(deepest_m, plan.theta_step_rad(), plan.theta_rad(63)) +
                           bend_m(deepest_m, plan.phi_step_rad(), plan.frame_phi_rad(37));
  for (const float error_m : error.map_m.pixels) {
    if (std::isnan(error_m)) continue;
    EXPECT_LE(std::abs(static_cast<double>(error_m)), largest_m);
  }
  EXPECT_GT(error.with_parted_rms_m, 5 * error.rms_m);
}

// A true point behind the surface that its stick meets.
TEST(SpacingError, PointsThatTheirStickDoesNotMeetAreHidden) {
  const auto plan = plan_of(64, 38);
  const auto ball = phantoms::still_at(
      phantoms::make_phantom({.name = "sphere", .radius_m = kRadius_m}), kCenter_m);
  const auto view = view_of(50 * kDegree);
  Truth truth = trace_truth(ball, plan, view);
  const SpacingError seen =
      spacing_error(truth, view.camera, plan, stick_ranges_m(ball, plan, view), every_pixel);
  EXPECT_EQ(seen.hidden, 0);
  int moved = 0;
  for (std::size_t i = 0; i < truth.kind.pixels.size(); i += 7) {
    if (truth.kind.pixels[i] != TruthKind::surface) continue;
    truth.depth_m.pixels[i] += 2e-3F;
    ++moved;
  }
  const SpacingError hidden =
      spacing_error(truth, view.camera, plan, stick_ranges_m(ball, plan, view), every_pixel);
  EXPECT_EQ(hidden.hidden, moved);
}

TEST(SpacingError, LeavesOutWhatNoFourSticksSupport) {
  const auto plan = plan_of(9, 7);
  const auto ball = phantoms::still_at(
      phantoms::make_phantom({.name = "sphere", .radius_m = kRadius_m}), kCenter_m);
  const auto view = view_of();
  const Truth truth = trace_truth(ball, plan, view);
  const SpacingError error =
      spacing_error(truth, view.camera, plan, stick_ranges_m(ball, plan, view), every_pixel);
  EXPECT_GT(error.unsupported, 0);
  const SpacingError none = spacing_error(
      truth, view.camera, plan, stick_ranges_m(ball, plan, view), [](int, int) { return false; });
  EXPECT_EQ(none.n, 0);
  EXPECT_TRUE(std::isnan(none.rms_m));
}

}  // namespace
}  // namespace wobblebench::bench
