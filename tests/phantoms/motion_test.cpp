// Motion against closed forms: exact inverses, each component alone and their order, and the head
// turn's preservation of volume and smoothness.
#include "phantoms/motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <random>

#include "phantoms/phantom.h"
#include "tests/support/expect.h"

namespace wobblebench::phantoms {
namespace {

constexpr double kPi = std::numbers::pi;
const Joint kJoint{{5e-3, -6e-3, 33e-3}, 40e-3, 50e-3};

std::string refusal(const MotionOptions& options, const std::optional<Joint>& joint = kJoint) {
  return refusal_of<InvalidPhantom>([&] { const Motion motion(options, joint); });
}

class RandomScene {
 public:
  explicit RandomScene(unsigned seed) : random_(seed) {}
  double within(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  glm::dvec3 vector(double reach) {
    return {within(-reach, reach), within(-reach, reach), within(-reach, reach)};
  }
  MotionOptions options() {
    MotionOptions o;
    o.velocity_m_s = vector(0.1);
    o.turn_rate_rad_s = vector(2);
    o.breath_amplitude_m = within(0, 20e-3);
    o.breath_period_s = within(0.5, 6);
    o.heartbeat_amplitude_m = within(0, 5e-3);
    o.heartbeat_period_s = within(0.3, 1.5);
    o.head_turn_rad = within(0, 0.69);
    o.head_turn_period_s = within(0.5, 5);
    o.head_axis = static_cast<HeadAxis>(std::uniform_int_distribution<int>(0, 2)(random_));
    return o;
  }

 private:
  std::mt19937 random_;
};

TEST(Motion, ToRestAndFromRestAreInverse) {
  RandomScene random(1);
  double moved = 0;
  for (int scene = 0; scene < 200; ++scene) {
    const Motion motion(random.options(), kJoint);
    for (int i = 0; i < 50; ++i) {
      const glm::dvec3 position = random.vector(0.12);
      const double time = random.within(0, 5);
      const glm::dvec3 now = motion.from_rest(position, time);
      ASSERT_LT(glm::distance(motion.to_rest(now, time), position), 1e-12);
      ASSERT_LT(glm::distance(motion.from_rest(motion.to_rest(position, time), time), position),
                1e-12);
      moved += glm::distance(now, position) / (200 * 50);
    }
  }
  EXPECT_GT(moved, 10e-3) << "mean displacement";
}

TEST(Motion, IsAtRestAtTimeZero) {
  RandomScene random(2);
  for (int scene = 0; scene < 50; ++scene) {
    const Motion motion(random.options(), kJoint);
    const glm::dvec3 position = random.vector(0.1);
    EXPECT_EQ(motion.from_rest(position, 0), position);
  }
  EXPECT_EQ(Motion().from_rest({1, 2, 3}, 7), glm::dvec3(1, 2, 3));
}

TEST(Motion, IsStillOrRigidAsItsOptionsSay) {
  EXPECT_TRUE(Motion().still());
  EXPECT_TRUE(Motion().rigid());
  MotionOptions path, turn, breath, heart, head;
  path.velocity_m_s = {0, 0, 1e-3};
  turn.turn_rate_rad_s = {0, 0.1, 0};
  breath.breath_amplitude_m = 1e-3;
  heart.heartbeat_amplitude_m = 1e-3;
  head.head_turn_rad = 0.1;
  EXPECT_TRUE(Motion({}, {}).still());
  for (const auto& options : {path, turn, breath, heart}) {
    EXPECT_FALSE(Motion(options, kJoint).still());
    EXPECT_TRUE(Motion(options, {}).rigid());
  }
  EXPECT_FALSE(Motion(head, kJoint).still());
  EXPECT_FALSE(Motion(head, kJoint).rigid());
}

TEST(Motion, FollowsThePath) {
  MotionOptions options;
  options.velocity_m_s = {10e-3, -20e-3, 5e-3};
  const Motion motion(options, {});
  const glm::dvec3 now = motion.from_rest({1e-3, 2e-3, 3e-3}, 0.5);
  EXPECT_LT(glm::distance(now, {6e-3, -8e-3, 5.5e-3}), 1e-15);
}

TEST(Motion, TurnsAboutTheOriginXThenYThenZ) {
  MotionOptions options;
  options.turn_rate_rad_s = {kPi / 2, kPi / 2, 0};
  const Motion motion(options, {});
  // y to z about x, then z to x about y.
  EXPECT_LT(glm::distance(motion.from_rest({0, 0.1, 0}, 1), {0.1, 0, 0}), 1e-15);
  EXPECT_LT(glm::length(motion.from_rest({0, 0, 0}, 1)), 1e-15);
}

TEST(Motion, BreathIsASineAlongY) {
  MotionOptions options;
  options.breath_amplitude_m = 8e-3;
  options.breath_period_s = 4;
  const Motion motion(options, {});
  for (double time = 0; time < 9; time += 0.37) {
    const glm::dvec3 moved =
        motion.from_rest({0.01, 0.02, 0.03}, time) - glm::dvec3(0.01, 0.02, 0.03);
    EXPECT_LT(glm::distance(moved, {0, 8e-3 * std::sin(kPi / 2 * time), 0}), 1e-15);
  }
}

TEST(Motion, HeartbeatIsAShortSmoothPulseAlongZ) {
  MotionOptions options;
  options.heartbeat_amplitude_m = 2e-3;
  options.heartbeat_period_s = 0.4;
  const Motion motion(options, {});
  const auto height = [&](double time) {
    const glm::dvec3 moved = motion.from_rest({0, 0, 0}, time);
    EXPECT_EQ(glm::dvec2(moved), glm::dvec2(0));
    return moved.z;
  };
  EXPECT_EQ(height(0), 0);
  EXPECT_NEAR(height(0.15 * 0.4), 2e-3, 1e-12);
  EXPECT_NEAR(height(0.075 * 0.4), 1e-3, 1e-12);
  for (double share = 0.3; share < 1; share += 0.07) EXPECT_EQ(height(0.4 * share + 1e-9), 0);
  EXPECT_NEAR(height(0.05), height(0.05 + 7 * 0.4), 1e-12);
  // C1: the speed has no jumps. It changes by no more than its largest slope, 2 a (pi / 0.12)^2.
  const double step = 1e-5, steepest = 2 * 2e-3 * std::pow(kPi / 0.12, 2);
  double before = 0;
  for (double time = 0; time < 1; time += step) {
    const double speed = (height(time + step) - height(time)) / step;
    ASSERT_LT(std::abs(speed - before), 1.01 * steepest * step) << time;
    before = speed;
  }
}

TEST(Motion, HeadTurnsRigidlyWithinTheJoint) {
  for (const auto axis : {HeadAxis::nod, HeadAxis::shake, HeadAxis::tilt}) {
    MotionOptions options;
    options.head_turn_rad = 0.3;
    options.head_turn_period_s = 2;
    options.head_axis = axis;
    const Motion motion(options, kJoint);
    glm::dvec3 angles{0};
    angles[static_cast<int>(axis)] = 0.3;  // at a quarter of the period
    const glm::dmat3 turn = rotation_xyz(angles);
    RandomScene random(3);
    for (int i = 0; i < 500; ++i) {
      const glm::dvec3 arm = random.vector(0.08);
      const glm::dvec3 now = motion.from_rest(kJoint.center_m + arm, 0.5) - kJoint.center_m;
      if (glm::length(arm) < kJoint.inner_m) {
        EXPECT_LT(glm::distance(now, turn * arm), 1e-15);
      } else if (glm::length(arm) > kJoint.outer_m) {
        EXPECT_LT(glm::distance(now, arm), 1e-16);
      } else {
        EXPECT_NEAR(glm::length(now), glm::length(arm), 1e-15) << "shells map onto themselves";
      }
    }
  }
}

// Angle by which the shell of this radius turns, at the peak.
double shell_angle(const Motion& motion, double radius_m) {
  const glm::dvec3 now =
      motion.from_rest(kJoint.center_m + glm::dvec3(radius_m, 0, 0), 0.5) - kJoint.center_m;
  return std::atan2(-now.z, now.x);
}

TEST(Motion, HeadTurnFallsOffTwiceDifferentiably) {
  MotionOptions options;
  options.head_turn_rad = 0.4;
  options.head_turn_period_s = 2;
  const Motion motion(options, kJoint);
  const double width = kJoint.outer_m - kJoint.inner_m, h = 1e-6;
  const auto curvature = [&](double r) {
    return (shell_angle(motion, r + h) - 2 * shell_angle(motion, r) + shell_angle(motion, r - h)) /
           (h * h);
  };
  double before = shell_angle(motion, kJoint.inner_m);
  EXPECT_NEAR(before, 0.4, 1e-12);
  EXPECT_NEAR(shell_angle(motion, 45e-3), 0.2, 1e-12) << "half-way";
  EXPECT_NEAR(shell_angle(motion, kJoint.outer_m), 0, 1e-12);
  // The second derivative is at most 10/sqrt(3) of angle / width^2, and 0 at both ends.
  const double most = 0.4 * 10 / std::sqrt(3) / (width * width);
  double last = 0;
  for (double r = kJoint.inner_m - 1e-3; r < kJoint.outer_m + 1e-3; r += 20e-6) {
    const double now = curvature(r);
    EXPECT_LT(std::abs(now), 1.01 * most);
    EXPECT_LT(std::abs(now - last), 0.06 * most) << "jumps at " << r;
    EXPECT_LE(shell_angle(motion, r + 20e-6), shell_angle(motion, r) + 1e-12);
    last = now;
  }
}

TEST(Motion, HeadTurnPreservesVolume) {
  RandomScene random(4);
  MotionOptions options = random.options();
  options.head_turn_rad = 0.6;
  const Motion motion(options, kJoint);
  const double h = 1e-6;
  for (int i = 0; i < 500; ++i) {
    const glm::dvec3 position = kJoint.center_m + random.vector(40e-3);
    glm::dmat3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 step{0};
      step[axis] = h;
      gradient[axis] =
          (motion.from_rest(position + step, 0.8) - motion.from_rest(position - step, 0.8)) /
          (2 * h);
    }
    ASSERT_NEAR(glm::determinant(gradient), 1, 1e-5);
  }
}

// The Jacobian in closed form against central differences, inside, within and outside the shell.
TEST(Motion, TangentIsTheDerivative) {
  RandomScene random(8);
  for (int i = 0; i < 300; ++i) {
    const Motion motion(random.options(), kJoint);
    const Deformation deformation = motion.at(random.within(0, 2));
    const glm::dvec3 rest_m = random.vector(0.1);
    const Deformation::Tangent tangent = deformation.tangent(rest_m);
    EXPECT_LT(glm::distance(tangent.position_m, deformation.from_rest(rest_m)), 1e-12);
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 step(0);
      step[axis] = 1e-6;
      const glm::dvec3 slope =
          (deformation.from_rest(rest_m + step) - deformation.from_rest(rest_m - step)) / 2e-6;
      EXPECT_LT(glm::distance(tangent.jacobian[axis], slope), 1e-6);
    }
  }
}

TEST(Motion, RigidRegionsOfTheHeadTurn) {
  MotionOptions options;
  options.velocity_m_s = {0.01, 0.02, -0.03};
  options.head_turn_rad = 0.4;
  const Deformation deformation = Motion(options, kJoint).at(0.3);
  const auto out = [](double from_center_m) {
    return kJoint.center_m + glm::dvec3(0, from_center_m, 0);
  };
  EXPECT_EQ(deformation.turn_within(out(30e-3), 9e-3), Deformation::Turn::full);
  EXPECT_EQ(deformation.turn_within(out(30e-3), 11e-3), Deformation::Turn::partial);
  EXPECT_EQ(deformation.turn_within(out(45e-3), 1e-6), Deformation::Turn::partial);
  EXPECT_EQ(deformation.turn_within(out(60e-3), 9e-3), Deformation::Turn::none);
  EXPECT_NEAR(deformation.rigid_radius_m(out(60e-3)), 10e-3, 1e-12);
  EXPECT_NEAR(deformation.rigid_radius_m(out(30e-3)), 10e-3, 1e-12);
  EXPECT_EQ(deformation.rigid_radius_m(out(45e-3)), 0);
  for (const auto& [turn, rest_m] :
       {std::pair{Deformation::Turn::full, out(30e-3)}, {Deformation::Turn::none, out(60e-3)}}) {
    const Deformation::Tangent whole = deformation.tangent_of(turn);
    EXPECT_LT(
        glm::distance(whole.position_m + whole.jacobian * rest_m, deformation.from_rest(rest_m)),
        1e-12);
  }
}

TEST(Motion, ComponentsActInTheirOrder) {
  MotionOptions options;
  options.velocity_m_s = {10e-3, 0, 0};
  options.turn_rate_rad_s = {0, 0, kPi / 2};
  options.breath_amplitude_m = 8e-3;
  options.breath_period_s = 4;
  options.heartbeat_amplitude_m = 2e-3;
  options.heartbeat_period_s = 1 / 0.15;
  options.head_turn_rad = 0.3;
  options.head_turn_period_s = 4;
  options.head_axis = HeadAxis::tilt;
  const Motion motion(options, kJoint);
  // At 1 s each is at its peak. Head by 0.3 about z, then breath and beat, then a quarter turn
  // about z through the origin, then the path.
  const glm::dvec3 arm{20e-3, 0, 4e-3};
  const glm::dvec3 head =
      kJoint.center_m + glm::dvec3(20e-3 * std::cos(0.3), 20e-3 * std::sin(0.3), 4e-3);
  const glm::dvec3 pulsed = head + glm::dvec3(0, 8e-3, 2e-3);
  const glm::dvec3 expected{-pulsed.y + 10e-3, pulsed.x, pulsed.z};
  EXPECT_LT(glm::distance(motion.from_rest(kJoint.center_m + arm, 1), expected), 1e-15);
}

TEST(Motion, RefusalsStateKeyValueAndAllowedRange) {
  MotionOptions options;
  options.velocity_m_s = {0, 0, 0.6};
  EXPECT_EQ(refusal(options), "velocity_mm_s = 600: must be within -500 and 500");
  options.velocity_m_s = {0, 0, std::nan("")};
  EXPECT_NE(refusal(options), "");
  options = {};
  options.breath_period_s = 0;
  EXPECT_EQ(refusal(options), "breath_period_s = 0: must be within 0.1 and 60");
  options = {};
  options.heartbeat_amplitude_m = -1e-3;
  EXPECT_EQ(refusal(options), "heartbeat_amplitude_mm = -1: must be within 0 and 10");
  options = {};
  options.head_turn_rad = 20 * kPi / 180;
  EXPECT_EQ(refusal(options), "");
  EXPECT_EQ(refusal(options, std::nullopt),
            "head_turn_deg = 20: this phantom has no head that turns; it must be 0");
}

}  // namespace
}  // namespace wobblebench::phantoms
