// The jaw's rise against a map that is written anew here: numeric integrals and bisection.

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <random>

#include "phantoms/motion.h"
#include "phantoms/phantom.h"
#include "tests/support/expect.h"

namespace wobblebench::phantoms {
namespace {

constexpr double kOpen = 6e-3, kReach = 16e-3, kPeriod = 2, kClose = 5.1e-3;

Mouth mouth() {
  return {rotation_xyz({-0.07, 0.14, -0.09}), {1e-3, 17e-3, 2e-3}, kOpen, kReach};
}

Motion moving_face(double turn_rad = 0) {
  MotionOptions options;
  options.mouth_close_m = kClose;
  options.mouth_period_s = kPeriod;
  options.head_turn_rad = turn_rad;
  return {options, Joint{{5e-3, -6e-3, 33e-3}, 40e-3, 50e-3, mouth()}};
}

class RandomPoints {
 public:
  explicit RandomPoints(unsigned seed) : random_(seed) {}
  double within(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  /// Near the mouth.
  glm::dvec3 rest_m() {
    return mouth().center_m + mouth().axes * glm::dvec3(within(-20e-3, 20e-3),
                                                        within(-12e-3, 48e-3),
                                                        within(-20e-3, 30e-3));
  }

 private:
  std::mt19937 random_;
};

// The share of the rise at a height below the middle of the gap, far above the neck: the integral
// of a slope that rises smoothly over 3 mm about the upper lip's edge and falls so about the lower.
double integrated_share(double height_m) {
  const auto step = [](double x) {
    const double u = std::min(1.0, std::max(0.0, x / 3e-3 + 0.5));
    return u * u * (3 - 2 * u);
  };
  const int steps = 20000;
  const double from = -6e-3, h = (height_m - from) / steps;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double y = from + (i + 0.5) * h;
    sum += h * (step(y + 3e-3) - step(y - 3e-3)) / kOpen;
  }
  return sum;
}

TEST(Mouth, ToRestAndFromRestAreInverse) {
  RandomPoints random(1);
  int displaced = 0;
  for (const double turn_rad : {0.0, 0.5}) {
    const Motion motion = moving_face(turn_rad);
    for (int i = 0; i < 20000; ++i) {
      const glm::dvec3 rest_m = random.rest_m();
      const double time_s = random.within(0, 3);
      const glm::dvec3 now_m = motion.from_rest(rest_m, time_s);
      ASSERT_LT(glm::distance(motion.to_rest(now_m, time_s), rest_m), 1e-12);
      ASSERT_LT(glm::distance(motion.from_rest(motion.to_rest(rest_m, time_s), time_s), rest_m),
                1e-12);
      displaced += turn_rad == 0 && glm::distance(now_m, rest_m) > 0.5e-3;
    }
  }
  EXPECT_GT(displaced, 2000);
}

TEST(Mouth, ClosesAsTheIntegralOfItsSlopeSays) {
  const Deformation closed = moving_face().at(kPeriod / 2);
  const auto on_axis = [&](double height_m) {
    return mouth().center_m + height_m * mouth().axes[1];
  };
  for (double height_m = -6e-3; height_m < 20e-3; height_m += 0.7e-3) {
    const glm::dvec3 expected = on_axis(height_m - kClose * integrated_share(height_m));
    EXPECT_LT(glm::distance(closed.from_rest(on_axis(height_m)), expected), 1e-9) << height_m;
  }
  // Within the gap the slope is 1 / opening but for the ends: 3/64 of the rise is left at each lip.
  const double gap_m =
      glm::distance(closed.from_rest(on_axis(3e-3)), closed.from_rest(on_axis(-3e-3)));
  EXPECT_NEAR(gap_m, kOpen - kClose * (1 - 2 * 3.0 / 64), 1e-12);
  const glm::dvec3 chin = on_axis(15e-3), half = moving_face().from_rest(chin, kPeriod / 4);
  EXPECT_NEAR(glm::dot(chin - half, mouth().axes[1]), kClose / 2, 1e-12) << "sin^2, half-way";
}

TEST(Mouth, MovesNothingAtTimeZeroAndAwayFromTheJaw) {
  RandomPoints random(2);
  const Motion motion = moving_face();
  const glm::dvec3 far[] = {{-17e-3, 5e-3, 5e-3},
                            {17e-3, 5e-3, 5e-3},
                            {0, -5e-3, 0},
                            {0, 44e-3, 5e-3},
                            {0, 5e-3, 26e-3},
                            {0, 5e-3, -17e-3}};
  for (const glm::dvec3& local_m : far) {
    const glm::dvec3 rest_m = mouth().center_m + mouth().axes * local_m;
    EXPECT_EQ(motion.from_rest(rest_m, 1), rest_m);
    EXPECT_EQ(motion.to_rest(rest_m, 1), rest_m);
    EXPECT_GT(motion.at(1).rigid_radius_m(rest_m), 0.3e-3);
  }
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 rest_m = random.rest_m();
    EXPECT_EQ(motion.from_rest(rest_m, 0), rest_m);
    const double radius_m = motion.at(1).rigid_radius_m(rest_m);
    if (radius_m > 0) {
      EXPECT_EQ(motion.from_rest(rest_m, 1), rest_m);
    }
    EXPECT_EQ(motion.at(1).turn_within(rest_m, 1e-3) == Deformation::Turn::none, radius_m >= 1e-3);
  }
}

TEST(Mouth, TangentIsTheDerivativeAndKeepsItsSign) {
  RandomPoints random(3);
  for (const double turn_rad : {0.0, 0.4}) {
    const Motion motion = moving_face(turn_rad);
    for (int i = 0; i < 5000; ++i) {
      const Deformation moment = motion.at(random.within(0, 2));
      const glm::dvec3 rest_m = random.rest_m();
      const Deformation::Tangent tangent = moment.tangent(rest_m);
      EXPECT_LT(glm::distance(tangent.position_m, moment.from_rest(rest_m)), 1e-15);
      for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 step(0);
        step[axis] = 1e-6;
        const glm::dvec3 slope =
            (moment.from_rest(rest_m + step) - moment.from_rest(rest_m - step)) / 2e-6;
        ASSERT_LT(glm::distance(tangent.jacobian[axis], slope), 2e-6);
      }
      // A turn preserves volume; the jaw leaves 1 - 5.1 / 6 of a height at least.
      const double volume = glm::determinant(tangent.jacobian);
      ASSERT_GT(volume, 0.15 - 1e-9);
      ASSERT_LT(volume, 1.5);
    }
  }
}

TEST(Mouth, BoundsHoldForNeighboursAndTimes) {
  RandomPoints random(4);
  const Motion motion = moving_face();
  const Motion::MouthBounds bounds = motion.mouth_bounds();
  double most_stretch = 0, fastest_m_s = 0;
  for (int i = 0; i < 50000; ++i) {
    const double time_s = random.within(0, 2);
    const glm::dvec3 now_m = random.rest_m();
    const glm::dvec3 rest_m = motion.to_rest(now_m, time_s);
    glm::dvec3 beside(random.within(-1, 1), random.within(-1, 1), random.within(-1, 1));
    beside = 1e-6 * glm::normalize(beside);
    most_stretch = std::max(most_stretch,
                            glm::distance(motion.to_rest(now_m + beside, time_s), rest_m) / 1e-6);
    fastest_m_s =
        std::max(fastest_m_s, glm::distance(motion.to_rest(now_m, time_s + 1e-6), rest_m) / 1e-6);
    ASSERT_LE(glm::distance(now_m, rest_m), bounds.shift_m);
  }
  EXPECT_LT(most_stretch, bounds.stretch);
  EXPECT_GT(most_stretch, bounds.stretch / 3);
  EXPECT_LT(fastest_m_s, bounds.speed_m_s);
  EXPECT_GT(fastest_m_s, bounds.speed_m_s / 10);
  EXPECT_TRUE(motion.without_mouth().still());
  EXPECT_FALSE(motion.rigid());
  EXPECT_FALSE(motion.still());
}

std::string motion_refusal(const MotionOptions& options, const std::optional<Joint>& joint) {
  return refusal_of<InvalidPhantom>([&] { const Motion motion(options, joint); });
}

TEST(Mouth, RefusalsStateKeyValueAndWhatIsAllowed) {
  MotionOptions options;
  options.mouth_close_m = 4e-3;
  const Joint head{{}, 40e-3, 50e-3, mouth()};
  EXPECT_EQ(motion_refusal(options, head), "");
  EXPECT_EQ(motion_refusal(options, Joint{{}, 40e-3, 50e-3, {}}),
            "mouth_close_mm = 4: this phantom has no open mouth; it must be 0");
  options.mouth_close_m = 5.2e-3;
  EXPECT_EQ(motion_refusal(options, head),
            "mouth_close_mm = 5.2: must be at most 5.1 for this mouth");
  options.mouth_close_m = 4e-3;
  options.mouth_period_s = 0;
  EXPECT_EQ(motion_refusal(options, head), "mouth_period_s = 0: must be within 0.1 and 60");
}

}  // namespace
}  // namespace wobblebench::phantoms
