#include "phantoms/shapes/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <random>

namespace wobblebench::phantoms {
namespace {

class Shapes : public testing::Test {
 protected:
  double number(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  glm::dvec3 point(double reach) {
    return {number(-reach, reach), number(-reach, reach), number(-reach, reach)};
  }
  std::mt19937 random_{7};
};

// Minimum over many balls along the axis.
double brute_round_cone(const glm::dvec3& p, const TubePoint& a, const TubePoint& b) {
  double nearest = 1e9;
  for (int i = 0; i <= 4000; ++i) {
    const double t = i / 4000.0;
    nearest = std::min(
        nearest,
        glm::distance(p, glm::mix(a.center, b.center, t)) - glm::mix(a.radius_m, b.radius_m, t));
  }
  return nearest;
}

TEST_F(Shapes, TubeIsTheConvexHullOfItsBalls) {
  for (int i = 0; i < 500; ++i) {
    const TubePoint a{point(1), number(0, 0.4)}, b{point(1), number(0, 0.4)};
    const glm::dvec3 p = point(2);
    ASSERT_NEAR(Tube({a, b}).distance(p), brute_round_cone(p, a, b), 1e-6) << i;
  }
}

TEST_F(Shapes, SmoothTubePassesThroughItsPoints) {
  const std::vector<TubePoint> points = {{{0, 0, 0}, 0.1}, {{1, 1, 0}, 0.2}, {{2, 0, 1}, 0.1}};
  const Tube tube = smooth_tube(points, 8);
  EXPECT_EQ(tube.points().size(), 17u);
  for (const TubePoint& point : points) EXPECT_LE(tube.distance(point.center), -point.radius_m);
}

TEST_F(Shapes, BoundsContainTheirShapes) {
  for (int i = 0; i < 200; ++i) {
    const Tube tube{{{point(1), number(0, 0.4)}, {point(1), number(0, 0.4)}}};
    const Ellipsoid ellipsoid{point(1), {number(0.1, 1), number(0.1, 1), number(0.1, 1)}};
    for (int j = 0; j < 50; ++j) {
      const glm::dvec3 p = point(3);
      const auto outside = [&](const Ball& ball) {
        return glm::distance(p, ball.center) > ball.radius_m;
      };
      ASSERT_TRUE(tube.distance(p) > 0 || !outside(tube.bound()));
      ASSERT_TRUE(ellipsoid.distance(p) > 0 || !outside(ellipsoid.bound()));
    }
  }
}

TEST_F(Shapes, EllipsoidIsExactForABallAndOnItsSurface) {
  const Ellipsoid ball{{1, 2, 3}, glm::dvec3(0.5)};
  EXPECT_NEAR(ball.distance({1, 2, 4.5}), 1.0, 1e-12);
  EXPECT_NEAR(ball.distance({1, 2, 3}), -0.5, 1e-12);
  const Ellipsoid egg{{0, 0, 0}, {1, 2, 3}};
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 on = glm::normalize(point(1)) * egg.radii_m;
    EXPECT_NEAR(egg.distance(on), 0, 1e-12);
  }
}

TEST_F(Shapes, FilletsActNearTheEdgeOnly) {
  EXPECT_DOUBLE_EQ(smooth_union(1, 3, 1), 1);
  EXPECT_DOUBLE_EQ(smooth_union(1, 1, 1), 0.75);
  EXPECT_DOUBLE_EQ(smooth_union(1, 2, 0), 1);
  EXPECT_DOUBLE_EQ(smooth_difference(-2, 5, 1), -2);
  EXPECT_DOUBLE_EQ(smooth_difference(-2, -3, 0), 3);
}

TEST_F(Shapes, CsgBodyAppliesItsOperationsInOrder) {
  const Ellipsoid body{{0, 0, 0}, glm::dvec3(1)};
  const Tube horn{{{{0.8, 0, 0}, 0.3}, {{1.6, 0.4, 0}, 0.1}}};
  const Ellipsoid hollow{{0.4, 0.9, 0}, glm::dvec3(0.4)};
  CsgBody csg;
  csg.unite(body, 0);
  csg.unite_pair(horn, 0.2);
  csg.subtract_pair(hollow, 0.1);
  const glm::dvec3 flip{-1, 1, 1};
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 p = point(2.5);
    double expected = smooth_union(body.distance(p), horn.distance(p), 0.2);
    expected = smooth_union(expected, horn.distance(flip * p), 0.2);
    expected = smooth_difference(expected, hollow.distance(p), 0.1);
    expected = smooth_difference(expected, hollow.distance(flip * p), 0.1);
    ASSERT_NEAR(csg.distance(p), expected, 1e-12);
  }
}

// Of egg-shaped and tubular operations, with and without fillets.
CsgBody random_body(const std::function<glm::dvec3(double)>& point) {
  CsgBody body;
  for (int i = 0; i < 12; ++i) {
    const double fillet = i % 3 == 0 ? 0 : 0.2 * (1 + point(1).x);
    if (i % 2 == 0) {
      body.unite(Ellipsoid{point(2), glm::dvec3(0.7) + 0.5 * point(1)}, fillet);
    } else {
      std::vector<TubePoint> points;
      for (int j = 0; j < 6; ++j) points.push_back({point(2), 0.3 + 0.2 * point(1).x});
      const Tube tube(points);
      if (i % 5 == 0) {
        body.subtract_pair(tube, fillet);
      } else {
        body.unite_pair(tube, fillet);
      }
    }
  }
  return body;
}

TEST_F(Shapes, ABodyNearABallHasTheSameDistancesThere) {
  for (int round = 0; round < 200; ++round) {
    const CsgBody body = random_body([&](double size) { return point(size); });
    const Ball ball{point(2), 0.02 * (1 + round % 40)};
    const CsgBody local = body.near(ball);
    for (int i = 0; i < 50; ++i) {
      const glm::dvec3 arm = point(1);
      const glm::dvec3 p = ball.center + ball.radius_m / std::max(1.0, glm::length(arm)) * arm;
      ASSERT_EQ(local.distance(p), body.distance(p)) << "round " << round;
    }
  }
}

TEST_F(Shapes, ATubeNearABallIsAsShortAsCanBe) {
  const Tube tube({{{0, 0, 0}, 0.1}, {{1, 0, 0}, 0.1}, {{2, 0, 0}, 0.1}, {{3, 0, 0}, 0.1}});
  const auto points = [&](double x, double radius) {
    return tube.near({{x, 0.3, 0}, radius}).points().size();
  };
  EXPECT_EQ(points(0.5, 0.1), 2U);
  EXPECT_EQ(points(1.0, 0.1), 3U);
  EXPECT_EQ(points(1.5, 2.0), 4U);
}

TEST_F(Shapes, MirrorReflectsTheAxes) {
  const double c = std::cos(0.4), s = std::sin(0.4);
  const Ellipsoid tilted{{0.5, 0.2, 0.1}, {1, 0.4, 0.3}, {c, -s, 0, s, c, 0, 0, 0, 1}};
  const Ellipsoid other = std::get<Ellipsoid>(mirrored(tilted));
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 p = point(2);
    EXPECT_NEAR(other.distance(glm::dvec3(-1, 1, 1) * p), tilted.distance(p), 1e-12);
  }
}

}  // namespace
}  // namespace wobblebench::phantoms
