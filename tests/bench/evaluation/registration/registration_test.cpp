// Recovery of known errors.
#include "bench/evaluation/registration/registration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/evaluation/truth/truth.h"
#include "bench/scene/resolved_scene.h"
#include "render/camera.h"

namespace wobblebench::bench {
namespace {

class KnownError : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scene_ = new Scene(load_scene({}, {"phantom.voxel_mm=1", "phantom.maternal_layer_mm=0"}));
    scene_->render.ray_casting.image_size = 128;
    const auto phantom = phantoms::make_phantom(scene_->phantom);
    const ResolvedScene resolved = resolve_scene(*scene_, phantom);
    *scene_ = resolved.options();
    subject_ = new phantoms::PlacedPhantom(*resolved.subject());
  }
  static void TearDownTestSuite() {
    delete subject_;
    delete scene_;
  }

  /// The depth image of the phantom at `actual`, registered to the phantom at the scene's
  /// placement.
  Registration registered(const phantoms::Placement& actual,
                          double bias_m = 0,
                          const phantoms::Motion& actual_motion = {},
                          const phantoms::Motion& assumed_motion = {}) {
    const auto plan = scene_->plan();
    Truth truth = trace_truth(
        {subject_->phantom, actual, actual_motion}, plan, render::make_view(scene_->render));
    for (float& depth : truth.depth_m.pixels) depth += static_cast<float>(bias_m);
    return register_surface(truth.depth_m,
                            {subject_->phantom, subject_->placement, assumed_motion},
                            plan,
                            render::make_view(scene_->render));
  }

  static Scene* scene_;
  static phantoms::PlacedPhantom* subject_;
};
Scene* KnownError::scene_ = nullptr;
phantoms::PlacedPhantom* KnownError::subject_ = nullptr;

TEST_F(KnownError, NoneLeavesEverythingNearZero) {
  const Registration fit = registered(subject_->placement);
  ASSERT_TRUE(fit.converged);
  EXPECT_GT(fit.points, 500);
  EXPECT_LT(fit.rms_after_m, 0.05e-3);
  for (int i = 0; i < 6; ++i)
    EXPECT_LT(std::abs(fit.value[static_cast<std::size_t>(i)]), 0.3e-3) << i;
  EXPECT_LT(std::abs(fit.value[6]), 2e-3);
}

TEST_F(KnownError, ShiftAcrossTheViewIsRecovered) {
  auto moved = subject_->placement;
  moved.position_m += glm::dvec3(1.0e-3, -0.7e-3, 0);
  const Registration fit = registered(moved);
  ASSERT_TRUE(fit.converged);
  EXPECT_GT(fit.rms_before_m, 3 * fit.rms_after_m);
  // The fit brings the detected points back onto the phantom: the opposite motion.
  EXPECT_NEAR(fit.value[3], -1.0e-3, 0.1e-3);
  EXPECT_NEAR(fit.value[4], 0.7e-3, 0.1e-3);
}

TEST_F(KnownError, RotationIsRecovered) {
  auto turned = subject_->placement;
  turned.rotation = phantoms::rotation_xyz({0, 0, 1.5 * kDegree}) * turned.rotation;
  const Registration fit = registered(turned);
  ASSERT_TRUE(fit.converged);
  EXPECT_NEAR(fit.value[2], -1.5 * kDegree, 0.1 * kDegree);
}

TEST_F(KnownError, DepthErrorIsSharedByCorrelatedParameters) {
  const Registration fit = registered(subject_->placement, 1.0e-3);
  ASSERT_TRUE(fit.converged);
  EXPECT_LT(fit.rms_after_m, 0.05e-3);
  // In a view along z bias and translation along z are equivalent; only their sum is observable.
  EXPECT_NEAR(fit.value[7] - fit.value[5], 1.0e-3, 0.3e-3);
  const double correlation = fit.covariance[7 * kRegistrationParameters + 5] /
                             (fit.standard_deviation(7) * fit.standard_deviation(5));
  EXPECT_GT(std::abs(correlation), 0.9);
}

TEST_F(KnownError, LargeDepthErrorsAreNotLeftOut) {
  // Beyond the phantom's own narrow bands (4 voxels of 1 mm here).
  const Registration fit = registered(subject_->placement, 5.0e-3);
  EXPECT_GT(fit.points, fit.sampled * 9 / 10);
  EXPECT_GT(fit.rms_before_m, 3e-3);
  EXPECT_NEAR(fit.value[7] - fit.value[5], 5.0e-3, 0.5e-3);
}

TEST_F(KnownError, WhatRepeatsCancelsInADifference) {
  // A detector's error of 1 mm that varies over the picture, and 0.5 mm of ray bias on top.
  const auto plan = scene_->plan();
  const auto view = render::make_view(scene_->render);
  const SurfaceRegistration registration(*subject_, plan, view);
  Image<float> found = trace_truth(*subject_, plan, view).depth_m;
  for (int row = 0; row < found.height; ++row) {
    for (int column = 0; column < found.width; ++column) {
      found.at(column, row) +=
          1e-3f * std::sin(0.11f * static_cast<float>(column) + 0.07f * static_cast<float>(row));
    }
  }
  Image<float> planted = found;
  for (float& z : planted.pixels) z += 0.5e-3f;
  const auto priors = RegistrationPriors::of_known_pose();
  const auto alone = registration.fit(planted, priors);
  const auto difference =
      registration.fit_difference(planted, registration.distances(found), priors);
  ASSERT_TRUE(difference.converged);
  EXPECT_NEAR(difference.value[kBias], 0.5e-3, 0.05e-3);
  EXPECT_NEAR(difference.value[kScale], 0, 1e-3);
  EXPECT_LT(difference.high[kBias] - difference.low[kBias],
            0.3 * (alone.high[kBias] - alone.low[kBias]));
  EXPECT_GT(difference.points, alone.points / 2) << "the rim of the head is left out";
}

TEST_F(KnownError, AKnownMotionIsNoError) {
  for (const bool head_turns : {false, true}) {
    phantoms::MotionOptions options;
    if (head_turns) {
      options.head_turn_rad = 10 * kDegree;
    } else {
      options.velocity_m_s = {5e-3, -10e-3, 15e-3};
    }
    const phantoms::Motion motion(options, subject_->phantom.joint());
    const auto placement = subject_->placement;
    const Registration known = registered(placement, 0, motion, motion);
    ASSERT_TRUE(known.converged);
    EXPECT_GT(known.points, 500);
    EXPECT_LT(known.rms_after_m, 0.05e-3);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_LT(std::abs(known.value[i]), 0.3e-3) << i;
    const Registration assumed_still = registered(placement, 0, motion);
    EXPECT_GT(assumed_still.rms_before_m, 0.5e-3);
    EXPECT_GT(assumed_still.rms_before_m, 10 * known.rms_before_m);
  }
}

TEST_F(KnownError, AShiftOfAMovingPhantomIsRecovered) {
  phantoms::MotionOptions options;
  options.velocity_m_s = {0, 0, 15e-3};
  const phantoms::Motion motion(options, subject_->phantom.joint());
  auto moved = subject_->placement;
  moved.position_m += glm::dvec3(1.0e-3, -0.7e-3, 0);
  const Registration fit = registered(moved, 0, motion, motion);
  ASSERT_TRUE(fit.converged);
  EXPECT_NEAR(fit.value[3], -1.0e-3, 0.1e-3);
  EXPECT_NEAR(fit.value[4], 0.7e-3, 0.1e-3);
}

TEST_F(KnownError, CovarianceIsSymmetricAndPositive) {
  const Registration fit = registered(subject_->placement);
  for (int i = 0; i < kRegistrationParameters; ++i) {
    const bool held = i == kMotorAngle || i == kWobbleRadius;
    EXPECT_EQ(fit.standard_deviation(i) > 0, !held) << i;
    for (int j = 0; j < kRegistrationParameters; ++j) {
      const auto at = [&](int r, int c) {
        return fit.covariance[static_cast<std::size_t>(r * kRegistrationParameters + c)];
      };
      EXPECT_NEAR(at(i, j), at(j, i), 1e-9 * std::sqrt(at(i, i) * at(j, j)) + 1e-20);
    }
  }
}

TEST(Registration, OfNothingDoesNotConverge) {
  Scene scene = load_scene({}, {"phantom.name=sphere", "phantom.voxel_mm=2"});
  scene.render.ray_casting.image_size = 32;
  const auto phantom = phantoms::make_phantom(scene.phantom);
  const ResolvedScene resolved = resolve_scene(scene, phantom);
  const Image<float> nothing(32, 32, kNoSurface);
  const auto fit = register_surface(nothing, *resolved.subject(), resolved.plan(), resolved.view());
  EXPECT_FALSE(fit.converged);
  EXPECT_FALSE(fit.within_priors);
  EXPECT_EQ(fit.points, 0);
  EXPECT_TRUE(std::isnan(fit.rms_before_m));
  EXPECT_TRUE(std::isnan(fit.value[0]));
  EXPECT_TRUE(std::isnan(fit.standard_deviation(7)));
}

}  // namespace
}  // namespace wobblebench::bench
