// A ball scanned by a motor that is not where the plan has it: sticks are placed by their own
// angles. Its radius and centre are fitted to the points of the picture.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <utility>

#include "render/camera.h"
#include "render/presets.h"
#include "render/reference/reference.h"
#include "render/renderer.h"
#include "tests/render/support/gl_fixture.h"
#include "tests/render/support/synthetic.h"

namespace wobblebench::render {
namespace {

constexpr double kBallRadius_m = 0.02;
const glm::dvec3 kBallCenter{0.004, -0.004, 0.09};
constexpr double kFan = 50 * kDegree;

hw::AcquisitionPlan plan_of(hw::MotorMode motor) {
  hw::AcquisitionOptions scan;
  scan.depth_m = 0.14;
  scan.sector_rad = 60 * kDegree;
  scan.fan_rad = kFan;
  scan.sticks_per_frame = 40;
  scan.samples_per_stick = 192;
  scan.frames_per_volume = 33;
  scan.motor = motor;
  return {hw::ProbeOptions{}, scan};
}

/// Finds the surface half the way up its edge, where it is.
RenderOptions options_of(Sticks sticks) {
  RenderOptions options = render_preset(RenderPreset::accurate);
  options.reconstruction.sticks = sticks;
  options.ray_casting.iso_level = 0.5;
  options.ray_casting.incidence_correction_m = 0;  // there is no beam
  options.ray_casting.image_size = 64;
  options.scan_conversion.slice_size = 192;
  options.volume_of_interest = {{0, 0, 0.095}, {0.06, 0.06, 0.06}};
  return options;
}

/// Time of a stick in its volume, 0 to 1, at which a planned motor goes from -1/2 to 1/2 of the
/// fan.
double time_of(const hw::AcquisitionPlan& plan, const hw::StickIndex& index) {
  return plan.motor_angle_rad(index) / kFan + 0.5;
}

struct Ball {
  glm::dvec3 center_m{0};
  double radius_m = 0;
};

/// Solves a linear system of four equations by Gauss's elimination.
std::array<double, 4> solved(std::array<std::array<double, 5>, 4> m) {
  for (std::size_t i = 0; i < 4; ++i) {
    const auto largest =
        std::max_element(m.begin() + std::ptrdiff_t(i), m.end(), [&](auto& a, auto& b) {
          return std::abs(a[i]) < std::abs(b[i]);
        });
    std::swap(m[i], *largest);
    for (std::size_t row = 0; row < 4; ++row) {
      if (row == i) continue;
      const double factor = m[row][i] / m[i][i];
      for (std::size_t k = i; k < 5; ++k) m[row][k] -= factor * m[i][k];
    }
  }
  return {m[0][4] / m[0][0], m[1][4] / m[1][1], m[2][4] / m[2][2], m[3][4] / m[3][3]};
}

/// Least squares of |p|^2 = 2 c p + (r^2 - |c|^2) over the points near the ball's pole.
Ball fitted(const Picture& picture, const RenderOptions& options) {
  const Camera camera = make_camera(options);
  std::array<std::array<double, 5>, 4> sums{};
  int count = 0;
  for (int row = 0; row < camera.image_size; ++row) {
    for (int column = 0; column < camera.image_size; ++column) {
      const hw::Ray ray = camera.ray(column, row);
      const double beside_m = glm::length(glm::cross(kBallCenter - ray.origin, ray.direction));
      const auto z_m = static_cast<double>(picture.depth_m.at(column, row));
      if (beside_m > 0.75 * kBallRadius_m || std::isnan(z_m)) continue;
      const glm::dvec3 p = 1e3 * (ray.at(z_m) - kBallCenter);
      const std::array<double, 5> equation{2 * p.x, 2 * p.y, 2 * p.z, 1, glm::dot(p, p)};
      for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t k = 0; k < 5; ++k) sums[i][k] += equation[i] * equation[k];
      }
      ++count;
    }
  }
  EXPECT_GT(count, 500);
  const auto [x, y, z, w] = solved(sums);
  const glm::dvec3 center(x, y, z);
  return {kBallCenter + 1e-3 * center, 1e-3 * std::sqrt(w + glm::dot(center, center))};
}

/// `tolerance_m`: of radius and centre.
void expect_ball(const hw::PolarVolume& volume, RenderOptions options, double tolerance_m) {
  for (const PipelineMode mode : {PipelineMode::fast, PipelineMode::plain}) {
    options.pipeline.mode = mode;
    const Ball ball = fitted(render_volume(testing::gl_context(), volume, options), options);
    EXPECT_NEAR(ball.radius_m, kBallRadius_m, tolerance_m);
    EXPECT_LE(glm::distance(ball.center_m, kBallCenter), tolerance_m)
        << 1e3 * (ball.center_m.x - kBallCenter.x) << ", "
        << 1e3 * (ball.center_m.y - kBallCenter.y) << ", "
        << 1e3 * (ball.center_m.z - kBallCenter.z) << " mm";
  }
}

hw::PolarVolume ball_scanned(const hw::AcquisitionPlan& plan,
                             const testing::MotorLaw& law,
                             std::uint32_t volume = 0) {
  return testing::sample_field(
      plan, testing::sphere(kBallCenter, kBallRadius_m, 3e-3), volume, law);
}

struct Law {
  const char* name;
  /// Share of the fan, from -1/2, at a time of the sweep from 0 to 1.
  double (*share)(double time);
};

const Law kLaws[] = {
    {"planned", [](double t) { return t - 0.5; }},
    {"sine", [](double t) { return -0.5 * std::cos(kPi * t); }},
    {"offset", [](double t) { return t - 0.5 + 0.06; }},
    {"narrow", [](double t) { return 0.8 * (t - 0.5); }},
    {"trapezoid",
     [](double t) {  // accelerates over a fifth, runs, and brakes over a fifth
       constexpr double kRamp = 0.2, kSpeed = 1 / (1 - kRamp);
       if (t < kRamp) return 0.5 * kSpeed * t * t / kRamp - 0.5;
       if (t > 1 - kRamp) return 0.5 - 0.5 * kSpeed * (1 - t) * (1 - t) / kRamp;
       return kSpeed * (t - 0.5 * kRamp) - 0.5;
     }},
    {"backlash", [](double t) { return std::max(t - 0.05, 0.0) - 0.5; }},
};

class BallScanned : public ::testing::TestWithParam<std::tuple<Law, hw::MotorMode>> {};

TEST_P(BallScanned, IsWhereItIs) {
  const Law& law = std::get<0>(GetParam());  // clang 14 captures no structured binding
  const hw::MotorMode motor = std::get<1>(GetParam());
  const hw::AcquisitionPlan plan = plan_of(motor);
  // Backlash: on the way back the motor lags in the other direction.
  const std::uint32_t volumes = motor == hw::MotorMode::alternating ? 2 : 1;
  for (std::uint32_t v = 0; v < volumes; ++v) {
    SCOPED_TRACE(v);
    const double direction = plan.sweep_direction(v);
    const hw::PolarVolume volume = ball_scanned(
        plan,
        [&](const hw::StickIndex& index) {
          const double time = 0.5 + direction * (time_of(plan, index) - 0.5);
          return direction * kFan * law.share(time);
        },
        v);
    expect_ball(volume, options_of(Sticks::aligned), 0.6e-3);
    expect_ball(volume, options_of(Sticks::plain), 0.6e-3);
  }
}

struct NamedByLawAndMotor {
  template <class Info>
  std::string operator()(const Info& info) const {
    const auto& [law, motor] = info.param;
    return std::string(law.name) + (motor == hw::MotorMode::stepped ? "_stepped" : "_alternating");
  }
};

INSTANTIATE_TEST_SUITE_P(MotorLaws,
                         BallScanned,
                         ::testing::Combine(::testing::ValuesIn(kLaws),
                                            ::testing::Values(hw::MotorMode::stepped,
                                                              hw::MotorMode::alternating)),
                         NamedByLawAndMotor());

/// Each stick has an angle of its own; frames are in order on each line, and unequally spaced.
hw::PolarVolume randomly_scanned(unsigned seed, hw::MotorMode motor) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0.3, 1.7), jitter(-0.25, 0.25);
  const hw::AcquisitionPlan plan = plan_of(motor);
  std::vector<double> at{0};
  for (int f = 1; f < plan.acquisition().frames_per_volume; ++f) {
    at.push_back(at.back() + uniform(random));
  }
  const double offset = 0.03 * kFan * jitter(random);
  return ball_scanned(plan, [&](const hw::StickIndex& index) {
    const double frame_rad = kFan * (at[index.frame] / at.back() - 0.5);
    return frame_rad + offset + 0.3 * jitter(random) * plan.phi_step_rad();
  });
}

/// Other laws with --gtest_shuffle --gtest_random_seed=N.
TEST(MotorAngles, OfRandomLawsPlaceABallWhereItIs) {
  const auto run = static_cast<unsigned>(::testing::UnitTest::GetInstance()->random_seed());
  for (unsigned seed = 6 * run; seed < 6 * run + 6; ++seed) {
    SCOPED_TRACE(seed);
    const auto motor = seed % 2 == 0 ? hw::MotorMode::stepped : hw::MotorMode::continuous;
    const hw::PolarVolume volume = randomly_scanned(seed, motor);
    expect_ball(volume, options_of(Sticks::aligned), 0.6e-3);
    expect_ball(volume, options_of(Sticks::plain), 0.8e-3);
  }
}

void expect_agreement(const hw::PolarVolume& volume, RenderOptions options) {
  const Picture expected = render_reference(volume, options);
  ASSERT_GT(testing::hits(expected.depth_m), 300);
  for (const PipelineMode mode : {PipelineMode::fast, PipelineMode::plain}) {
    options.pipeline.mode = mode;
    const Picture made = render_volume(testing::gl_context(), volume, options);
    const auto depth = testing::compare(made.depth_m, expected.depth_m);
    EXPECT_LE(depth.rms_m, 0.1 * step_m(options));
    EXPECT_LE(depth.changed_share, 0.002);
    EXPECT_LE(testing::compare(made.volume, expected.volume, 0.005).failing_share, 0.005);
  }
}

TEST(MotorAngles, AreTheSameToBothModesAndTheReference) {
  const hw::AcquisitionPlan plan = plan_of(hw::MotorMode::continuous);
  const hw::PolarVolume random = randomly_scanned(7, hw::MotorMode::continuous);
  // A fan of which a third is not covered: the picture ends within the box.
  const hw::PolarVolume partly = ball_scanned(
      plan, [&](const hw::StickIndex& index) { return plan.motor_angle_rad(index) + 0.35 * kFan; });
  for (const Sticks sticks : {Sticks::aligned, Sticks::plain}) {
    RenderOptions options = options_of(sticks);
    options.ray_casting.image_size = 40;
    expect_agreement(random, options);
    expect_agreement(partly, options);
    options.ray_casting.kernel_space = KernelSpace::ray;
    options.view.pitch_rad = 50 * kDegree;
    expect_agreement(partly, options);
  }
}

TEST(MotorAngles, ThatAreThePlansButForRoundingChangeNoBit) {
  const hw::AcquisitionPlan plan = plan_of(hw::MotorMode::alternating);
  for (const std::uint32_t v : {0U, 1U}) {
    const hw::PolarVolume exact = ball_scanned(plan, {}, v);
    hw::PolarVolume rounded(plan, v);
    for (int f = 0; f < plan.acquisition().frames_per_volume; ++f) {
      hw::PolarFrame frame = exact.frame(f);
      for (double& phi_rad : frame.motor_angle_rad) {
        phi_rad = static_cast<double>(static_cast<float>(phi_rad));
      }
      rounded.place_frame(f, frame, exact.scale());
    }
    const RenderOptions options = options_of(Sticks::aligned);
    const Picture one = render_volume(testing::gl_context(), exact, options);
    const Picture other = render_volume(testing::gl_context(), rounded, options);
    EXPECT_TRUE(testing::same_bits(one.depth_m, other.depth_m));
    EXPECT_TRUE(testing::same_bits(one.volume, other.volume));
  }
}

/// A renderer of a stream: after a volume that leaves the plan comes one that keeps to it.
TEST(MotorAngles, OfOneVolumeDoNotMoveTheNext) {
  const hw::AcquisitionPlan plan = plan_of(hw::MotorMode::stepped);
  const hw::PolarVolume planned = ball_scanned(plan, {});
  const hw::PolarVolume moved = randomly_scanned(3, hw::MotorMode::stepped);
  for (const Sticks sticks : {Sticks::aligned, Sticks::plain}) {
    const RenderOptions options = options_of(sticks);
    Renderer renderer(testing::gl_context(), plan, options);
    Picture first, last;
    for (const hw::PolarVolume* volume : {&planned, &moved, &planned}) {
      renderer.add_volume(*volume);
      last = renderer.render();
      if (volume == &planned && first.depth_m.pixels.empty()) first = last;
    }
    EXPECT_TRUE(testing::same_bits(first.depth_m, last.depth_m));
    EXPECT_TRUE(testing::same_bits(first.volume, last.volume));
  }
}

TEST(MotorAngles, OfLostSticksFollowTheirNeighbours) {
  const hw::AcquisitionPlan plan = plan_of(hw::MotorMode::stepped);
  const hw::PolarVolume whole = ball_scanned(
      plan, [&](const hw::StickIndex& index) { return plan.motor_angle_rad(index) + 0.06 * kFan; });
  hw::PolarVolume damaged(plan);
  std::mt19937 random(5);
  for (int f = 0; f < plan.acquisition().frames_per_volume; ++f) {
    hw::PolarFrame frame = whole.frame(f);
    for (auto& arrived : frame.arrived) arrived = random() % 5 != 0;
    damaged.place_frame(f, frame, whole.scale());
  }
  expect_ball(damaged, options_of(Sticks::aligned), 0.6e-3);
}

}  // namespace
}  // namespace wobblebench::render
