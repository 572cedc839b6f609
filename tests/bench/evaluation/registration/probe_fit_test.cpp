// Planted errors of the probe, on points of surfaces in closed form.
#include "bench/evaluation/registration/registration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

namespace wobblebench::bench {
namespace {

struct Ball {
  glm::dvec3 centre;
  double radius_m;
};

/// Balls, and perhaps a plane behind them.
struct Bodies {
  std::vector<Ball> balls;
  std::optional<double> plane_z_m;

  phantoms::SurfaceFinder::Distance distance(const glm::dvec3& p) const {
    phantoms::SurfaceFinder::Distance nearest{1e9, {0, 0, -1}};
    if (plane_z_m) nearest.value_m = *plane_z_m - p.z;
    for (const Ball& ball : balls) {
      const double value = glm::distance(p, ball.centre) - ball.radius_m;
      if (value < nearest.value_m) nearest = {value, glm::normalize(p - ball.centre)};
    }
    return nearest;
  }
  /// First along a ray.
  std::optional<double> hit(const hw::Ray& ray) const {
    double first = plane_z_m ? (*plane_z_m - ray.origin.z) / ray.direction.z : 1e9;
    for (const Ball& ball : balls) {
      const glm::dvec3 to = ball.centre - ray.origin;
      const double along = glm::dot(to, ray.direction);
      const double root = ball.radius_m * ball.radius_m - glm::dot(to, to) + along * along;
      if (root > 0) first = std::min(first, along - std::sqrt(root));
    }
    return first < 1e8 ? std::optional(first) : std::nullopt;
  }
};

const Bodies kScene{
    {{{0, 0, 0.12}, 0.025}, {{-0.02, 0.03, 0.13}, 0.02}, {{0.03, -0.03, 0.12}, 0.015}}, 0.13};
const Bodies kOneBall{{{{0, 0, 0.12}, 0.025}}, {}};

struct Planted {
  double scale = 0, bias_m = 0, motor_angle_rad = 0, wobble_radius_m = 0;
};
const Planted kAll{0.01, 0.5e-3, 1 * kDegree, 1e-3};

/// What a scanner that does not know the planted errors measures, from a slanting view.
std::vector<MeasuredPoint> measured(const Bodies& bodies, const Planted& planted, double noise_m) {
  hw::ProbeOptions truth;
  truth.wobble_radius_m += planted.wobble_radius_m;
  const hw::ProbeGeometry probe(truth);
  const glm::dvec3 view = glm::normalize(glm::dvec3(0.2, 0.1, 1));
  std::mt19937 generator(1);
  std::normal_distribution<double> normal(0, noise_m);
  std::vector<MeasuredPoint> points;
  for (int row = -30; row <= 30; ++row) {
    for (int column = -30; column <= 30; ++column) {
      const hw::Ray ray{{1.5e-3 * column - 0.012, 1.5e-3 * row - 0.006, 0.05}, view};
      const auto hit = bodies.hit(ray);
      if (!hit) continue;
      const double noise = noise_m > 0 ? normal(generator) : 0;
      hw::PolarPoint polar = probe.to_polar(ray.at(*hit + planted.bias_m + noise));
      polar.range_m /= 1 + planted.scale;
      polar.phi_rad -= planted.motor_angle_rad;
      points.push_back({polar, view, {}, (row + 30) / 3 * 100 + (column + 30) / 3});
    }
  }
  return points;
}

Registration fit(const Bodies& bodies,
                 const Planted& planted,
                 const RegistrationPriors& priors,
                 double noise_m = 0) {
  return fit_probe(
      measured(bodies, planted, noise_m),
      [&](const glm::dvec3& p, const hw::StickIndex&) { return bodies.distance(p); },
      hw::ProbeGeometry(hw::ProbeOptions{}),
      priors);
}

bool names(const Registration& result, int parameter) {
  return std::any_of(result.unseen.begin(), result.unseen.end(), [&](const auto& unseen) {
    return std::count(unseen.parameters.begin(), unseen.parameters.end(), parameter) > 0;
  });
}

TEST(ProbeFit, PlantedErrorsAreRecoveredWithoutNoise) {
  const auto result = fit(kScene, kAll, RegistrationPriors::of_known_pose());
  ASSERT_TRUE(result.converged);
  EXPECT_NEAR(result.value[kScale], kAll.scale, 0.01 * kAll.scale);
  EXPECT_NEAR(result.value[kBias], kAll.bias_m, 0.01 * kAll.bias_m);
  EXPECT_NEAR(result.value[kMotorAngle], kAll.motor_angle_rad, 0.01 * kAll.motor_angle_rad);
  EXPECT_NEAR(result.value[kWobbleRadius], kAll.wobble_radius_m, 0.01 * kAll.wobble_radius_m);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(result.value[static_cast<std::size_t>(i)], 0) << i;
  EXPECT_TRUE(result.unseen.empty());
  EXPECT_TRUE(result.within_priors);
}

TEST(ProbeFit, EachPlantedErrorIsRecoveredAlone) {
  const auto recovered = [&](const Planted& planted) {
    const auto value = fit(kScene, planted, RegistrationPriors::of_known_pose()).value;
    return Planted{value[kScale], value[kBias], value[kMotorAngle], value[kWobbleRadius]};
  };
  for (int one = 0; one < 4; ++one) {
    const Planted planted{
        one == 0 ? 0.01 : 0, one == 1 ? 0.5e-3 : 0, one == 2 ? kDegree : 0, one == 3 ? 1e-3 : 0};
    const Planted found = recovered(planted);
    EXPECT_NEAR(found.scale, planted.scale, 1e-4) << one;
    EXPECT_NEAR(found.bias_m, planted.bias_m, 5e-6) << one;
    EXPECT_NEAR(found.motor_angle_rad, planted.motor_angle_rad, 0.01 * kDegree) << one;
    EXPECT_NEAR(found.wobble_radius_m, planted.wobble_radius_m, 1e-5) << one;
  }
}

TEST(ProbeFit, IntervalsOfNoisyPointsHoldThePlantedErrors) {
  const auto result = fit(kScene, kAll, RegistrationPriors::of_known_pose(), 0.2e-3);
  const std::array<std::pair<int, double>, 4> planted = {{{kScale, kAll.scale},
                                                          {kBias, kAll.bias_m},
                                                          {kMotorAngle, kAll.motor_angle_rad},
                                                          {kWobbleRadius, kAll.wobble_radius_m}}};
  for (const auto& [parameter, value] : planted) {
    const auto slot = static_cast<std::size_t>(parameter);
    EXPECT_LT(result.low[slot], value) << parameter;
    EXPECT_GT(result.high[slot], value) << parameter;
    EXPECT_LT(result.high[slot] - result.low[slot], 2 * value) << parameter;
  }
  EXPECT_LT(result.variance_inflation, 2) << "the noise is independent";
}

TEST(ProbeFit, AMotorOffsetOfAnUnknownPoseIsNamed) {
  const auto result =
      fit(kScene, {.motor_angle_rad = 1 * kDegree}, RegistrationPriors::of_nothing_known(), 0.2e-3);
  EXPECT_TRUE(names(result, kMotorAngle));
  EXPECT_TRUE(names(result, kRotation)) << "the wobble axis is parallel to x";
  EXPECT_FALSE(names(result, kScale));
  EXPECT_GT(result.standard_deviation(kMotorAngle), 0.01);
}

TEST(ProbeFit, RotationsOfABallAreNamed) {
  const auto result = fit(kOneBall, {}, RegistrationPriors::of_nothing_known(), 0.1e-3);
  ASSERT_TRUE(result.converged);
  for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(names(result, kRotation + axis)) << axis;
  // A ball's rotation about its own centre keeps the prior's spread.
  EXPECT_GT(result.standard_deviation(kRotation + 2), 0.03);
}

TEST(ProbeFit, FewPointsAreNotFitted) {
  auto points = measured(kScene, {}, 0);
  points.resize(kLeastPoints - 1);
  const auto result = fit_probe(
      points,
      [](const glm::dvec3& p, const hw::StickIndex&) { return kScene.distance(p); },
      hw::ProbeGeometry(hw::ProbeOptions{}));
  EXPECT_FALSE(result.converged);
  EXPECT_TRUE(std::isnan(result.low[kScale]));
}

}  // namespace
}  // namespace wobblebench::bench
